/// Soundness where tapered primitives overlap: no enclosure of a depth, searched for by a device or the host, misses
/// it.
///
/// Random unions of three primitives, two of them tapered, and points that lie in more than one of them, against
/// MPFR, sampling and an octree (tests/oracle/solid_reference.hpp). The full run is
///   VERISQ_TAPERED_UNION_CASES=10000 build/release/tests/soundness_test --gtest_filter='TaperedUnion*'
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>
#include <verisq/device.hpp>
#include <verisq/distance.hpp>

#include "tests/fixtures/map_in_memory.hpp"
#include "tests/fixtures/requested_count.hpp"
#include "tests/oracle/in_parallel.hpp"
#include "tests/oracle/solid_escape.hpp"
#include "tests/oracle/tapered_contact.hpp"

namespace verisq::oracle {
namespace {

constexpr std::size_t points_a_union = 40;
constexpr std::size_t cubes = 3000;
constexpr double relative_tolerance = 1e-6;

struct Case {
  Model model;
  std::vector<Point> points;
};

/// About the origin, of sizes near 1, each primitive with a good part of the others in it. All share one program.
Model random_union(std::mt19937_64& random) {
  Model model;
  for (int i = 0; i < 3; ++i) {
    Primitive primitive = random_tapered(random, i == 2 ? 1.0 : 19.0);
    primitive.name = fmt::format("part {}", i);
    Superquadric& solid = primitive.superquadric;
    for (double& e : solid.exponents) e = std::clamp(e, 0.05, 2.0);
    const double largest = std::ranges::max(solid.semi_axes);
    for (double& a : solid.semi_axes) a = std::max(a / largest, 0.15);
    for (double& t : primitive.pose.translation) t = std::uniform_real_distribution(-0.3, 0.3)(random);
    model.primitives.push_back(primitive);
  }
  return model;
}

/// Of points that two primitives or more contain.
Case random_case(std::uint64_t index) {
  std::mt19937_64 random(index);
  for (;;) {
    Case result{random_union(random), {}};
    const PlacedModel placed(result.model);
    std::uniform_real_distribution within(-1.0, 1.0);
    for (int i = 0; i < 20'000 && result.points.size() < points_a_union; ++i) {
      const Point point{within(random), within(random), within(random)};
      const auto inside = [&](const PlacedPrimitive& p) { return p.membership(point) == Membership::inside; };
      if (std::ranges::count_if(placed.primitives(), inside) > 1) result.points.push_back(point);
    }
    if (result.points.size() == points_a_union) return result;
  }
}

TEST(TaperedUnionSoundnessTest, DepthsInOverlapsContainTheReferenceAndMeetTheHosts) {
  if (test_devices().empty()) GTEST_SKIP() << "NO OPENCL DEVICE: the soundness of the kernels was NOT tested";
  const std::size_t unions =
      std::max<std::size_t>(1, requested_count("VERISQ_TAPERED_UNION_CASES", 80) / points_a_union);
  std::size_t by_device = 0;
  std::size_t wide = 0;
  std::size_t sharp = 0;
  std::size_t overlapping = 0;  // deeper in the union than in any of its primitives
  for (std::size_t k = 0; k < unions; ++k) {
    const Case tested = random_case(k);
    const SolidReference reference(tested.model);
    const SignedDistance host(tested.model);
    const double tolerance = relative_tolerance * reference.size();
    const FinishedMap map = map_in_memory(tested.model, tested.points, {.tolerance = tolerance});
    by_device += map.summary.device_verified;
    wide += map.summary.wide;
    std::vector<SolidFacts> facts(points_a_union);
    std::vector<Enclosure> again(points_a_union);
    std::vector<double> alone(points_a_union, infinity);
    in_parallel(points_a_union, [&](std::size_t i) {
      facts[i] = reference.facts(tested.points[i], cubes);
      again[i] = host(tested.points[i], 1e-4 * reference.size());
      for (const Primitive& primitive : tested.model.primitives)
        alone[i] = std::min(alone[i], SignedDistance({"", {primitive}, {}})(tested.points[i], tolerance).lo);
    });
    for (std::size_t i = 0; i < points_a_union; ++i) {
      const Enclosure& found = map.rows.at(i).distance;
      for (const Enclosure& enclosure : {found, again[i]}) {
        const auto evidence = escape(enclosure, tested.model, tested.points[i], facts[i].lower, facts[i].upper);
        if (evidence) ADD_FAILURE() << *evidence;
      }
      EXPECT_TRUE(found.lo <= again[i].hi && again[i].lo <= found.hi) << model_json(tested.model);
      sharp += found.hi - facts[i].lower < 1e-4 * reference.size() ? 1 : 0;
      overlapping += found.hi < alone[i] ? 1 : 0;
    }
  }
  const std::size_t cases = unions * points_a_union;
  fmt::print("{} points in {} unions: {} by the device, {} wide; {} deeper than in one primitive; {} within 1e-4\n",
             cases, unions, by_device, wide, overlapping, sharp);
  EXPECT_EQ(wide, 0U);
  EXPECT_GT(10 * by_device, 9 * cases);
  EXPECT_GT(2 * sharp, cases) << "the reference would hardly notice an escape";
  EXPECT_GT(2 * overlapping, cases) << "one primitive decides";
}

}  // namespace
}  // namespace verisq::oracle
