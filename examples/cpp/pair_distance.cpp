/// The distance of two models, one of them moved, and what is proven of it.
#include <cstdio>
#include <verisq/distance.hpp>
#include <verisq/files.hpp>

int main() {
  const verisq::PairDistance distance(verisq::read_model("examples/capsule.json"),
                                      verisq::read_model("examples/soap.json"));
  const verisq::ModelDistance found = distance({.translation = {200.0, 0.0, 0.0}});
  const bool separated = found.proximity == verisq::Proximity::separated;
  std::printf("%s: [%.17g, %.17g]\n", separated ? "separated" : "not proven separated", found.distance.lo,
              found.distance.hi);
}
