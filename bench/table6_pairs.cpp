/// One core a row, but for the devices' rows, which take what the device has.
#include "bench/table6_pairs.hpp"

#include <algorithm>
#include <memory>
#include <verisq/distance.hpp>
#include <verisq/map.hpp>

#include "bench/certified_proposal.hpp"
#include "bench/peer_fcl_libccd.hpp"
#include "bench/peer_ipopt.hpp"
#include "bench/points.hpp"
#include "bench/posed_pairs.hpp"
#include "bench/tools.hpp"

namespace verisq::bench {
namespace {

constexpr std::size_t count = 100'000;
constexpr std::size_t slow_count = 1'000;  // for tools that take a millisecond, or nearly
constexpr std::size_t ipopt_count = 200;
constexpr double tolerance = 1e-12;  // of the larger size

}  // namespace

Table6Pairs::Table6Pairs(const BenchmarkPair& pair)
    : a_{"a", pair.a, {}},
      b_{"b", pair.b, {}},
      queries_{"pair",
               pair.name,
               tolerance * std::max(size_of(pair.a), size_of(pair.b)),
               separated_poses(pair.a, pair.b, count),
               slow_count,
               one_by_one<Pose>([distance = std::make_shared<PairDistance>(Model{"", {a_}}, Model{"", {b_}})](
                                    const Pose& pose) { return (*distance)(pose).distance; })} {}

void Table6Pairs::add_rows(std::span<const DeviceReport> devices) const {
  const Superquadric& a = a_.superquadric;
  const Superquadric& b = b_.superquadric;
  const auto posed_b = [&b](const Pose& pose) { return Primitive{"b", b, pose}; };
  add_unverified_row("verisq_published", queries_, slow_count, [this, posed_b] {
    return [this, posed_b](const Pose& pose) { return unverified_distance(a_, posed_b(pose)); };
  });
  add_verified_row("verisq_published", queries_, slow_count, [this, posed_b] {
    return one_by_one<Pose>([this, posed_b](const Pose& pose) { return published_distance(a_, posed_b(pose)); });
  });
  add_verified_row("verisq_host", queries_, slow_count, [this] {
    return one_by_one<Pose>(
        [host = PairDistance(Model{"", {a_}}, Model{"", {b_}})](const Pose& pose) { return host(pose).distance; });
  });
  for (const DeviceReport& device : devices) add_device_rows(device);
  add_unverified_row("fcl_libccd", queries_, count, [&a, &b] {
    return [fcl = LibccdPairDistance(a, b)](const Pose& pose) { return answer_of_fcl(fcl(pose)); };
  });
  add_unverified_row("ipopt", queries_, ipopt_count, [&a, &b] {
    return [ipopt = std::make_unique<IpoptPairDistance>(a, b, IpoptHessian::exact)](const Pose& pose) {
      const auto found = (*ipopt)(pose);
      return found ? found->distance : no_answer;
    };
  });
  add_verified_row("ipopt", queries_, ipopt_count, [&a, &b] {
    return one_by_one<Pose>([ipopt = std::make_unique<IpoptPairDistance>(a, b, IpoptHessian::exact),
                             certify = PairCertifier(a, b)](const Pose& pose) {
      const auto found = (*ipopt)(pose);
      return found ? certify(pose, found->on_a, found->on_b) : no_enclosure;
    });
  });
}

void Table6Pairs::add_device_rows(const DeviceReport& device) const {
  add_verified_row(tool_name(device), queries_, count, [this, device] {
    const MapOptions options{queries_.tolerance, std::to_string(device.index)};
    auto mapper = std::make_unique<PoseMapper>(Model{"", {a_}}, Model{"", {b_}}, options);
    std::vector<Enclosure> enclosures;
    map_all(*mapper, queries_.all, enclosures);  // OpenCL puts off work to the first launch
    return [mapper = std::move(mapper), enclosures](std::span<const Pose> poses) mutable {
      map_all(*mapper, poses, enclosures);
      return enclosures;
    };
  });
}

}  // namespace verisq::bench
