/// One core a row, but for the devices' rows, which take what the device has.
#include "bench/table6_points.hpp"

#include <algorithm>
#include <memory>
#include <verisq/distance.hpp>

#include "bench/certified_proposal.hpp"
#include "bench/peer_fcl_libccd.hpp"
#include "bench/peer_ipopt.hpp"
#include "bench/point_distance_kernel.hpp"
#include "bench/points.hpp"
#include "bench/tools.hpp"

namespace verisq::bench {
namespace {

constexpr std::size_t count = 100'000;     // as in the paper
constexpr std::size_t slow_count = 1'000;  // for tools that take milliseconds, or nearly
constexpr std::size_t ipopt_count = 500;
constexpr double tolerance = 1e-12;  // of the size, as in point_distance_bench

}  // namespace

Table6Points::Table6Points(const BenchmarkObject& object)
    : solid_{std::string(object.name), object.solid, {}},
      model_{"", {solid_}},
      queries_{"point",
               object.name,
               tolerance * size_of(object.solid),
               points_outside(object.solid, count),
               count,
               [this](std::span<const Point> points) {
                 PointMapper mapper(model_, {queries_.tolerance});
                 std::vector<Enclosure> enclosures;
                 map_all(mapper, points, enclosures);
                 return enclosures;
               }} {}

void Table6Points::add_device_rows(const DeviceReport& device) const {
  const std::string tool = tool_name(device);
  add_row(tool, "point", queries_.object, [this, device](benchmark::State& state) {
    PointDistanceKernel kernel(device, KernelVariant::solver_only, solid_.superquadric, queries_.all);
    for (auto _ : state) kernel.run();
    rows::set_counts(state, kernel.points(), 0);
  });
  add_verified_row(tool, queries_, count, [this, device] {
    const MapOptions options{queries_.tolerance, std::to_string(device.index)};
    auto mapper = std::make_unique<PointMapper>(model_, options);
    std::vector<Enclosure> enclosures;
    map_all(*mapper, queries_.all, enclosures);  // OpenCL puts off work to the first launch
    return [mapper = std::move(mapper), enclosures](std::span<const Point> points) mutable {
      map_all(*mapper, points, enclosures);
      return enclosures;
    };
  });
}

void Table6Points::add_rows(std::span<const DeviceReport> devices) const {
  const Superquadric& solid = solid_.superquadric;
  // What does better: for the gem the exact Hessian takes three times as long and fails for every twentieth point.
  const IpoptHessian hessian =
      std::ranges::max(solid.exponents) > 1.0 ? IpoptHessian::limited_memory : IpoptHessian::exact;
  add_unverified_row("verisq_published", queries_, slow_count,
                     [this] { return [this](const Point& q) { return unverified_distance(solid_, q); }; });
  add_verified_row("verisq_published", queries_, slow_count, [this] {
    return one_by_one<Point>([this](const Point& q) { return published_distance(solid_, q); });
  });
  add_verified_row("verisq_host", queries_, slow_count, [this] {
    return one_by_one<Point>([host = SignedDistance(model_)](const Point& q) { return host(q, 0.0); });
  });
  for (const DeviceReport& device : devices) add_device_rows(device);
  add_unverified_row("fcl_libccd", queries_, count, [&solid] {
    return [fcl = LibccdPointDistance(solid)](const Point& q) { return answer_of_fcl(fcl(q)); };
  });
  add_unverified_row("ipopt", queries_, ipopt_count, [&solid, hessian] {
    return [ipopt = std::make_unique<IpoptPointDistance>(solid, hessian)](const Point& q) {
      const auto found = (*ipopt)(q);
      return found ? found->distance : no_answer;
    };
  });
  add_verified_row("ipopt", queries_, ipopt_count, [&solid, hessian] {
    return one_by_one<Point>([ipopt = std::make_unique<IpoptPointDistance>(solid, hessian),
                              certify = PointCertifier(solid)](const Point& q) {
      const auto found = (*ipopt)(q);
      return found ? certify(q, found->on_solid) : no_enclosure;
    });
  });
}

}  // namespace verisq::bench
