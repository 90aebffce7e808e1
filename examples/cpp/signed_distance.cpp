/// The signed distance of one point to a model, proven by the host alone.
#include <cstdio>
#include <verisq/distance.hpp>
#include <verisq/files.hpp>

int main() {
  const verisq::SignedDistance distance(verisq::read_model("examples/soap.json"));
  const auto [lo, hi] = distance({10.0, 0.0, 0.0}, 1e-12);  // lo <= 6.6 <= hi: the soap ends at x = 3.4
  std::printf("[%.17g, %.17g]\n", lo, hi);
}
