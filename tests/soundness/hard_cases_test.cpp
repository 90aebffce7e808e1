/// No convex point stays wide: what a device's Newton iteration leaves open on hard solids, the host closes.
///
/// Random exponents from 0.05 to 1.95, at the ends too, and axis ratios to 400; points outside, at tolerance 1e-6 of
/// the solid's size. VERISQ_HARD_CASES sets the number of cases; the full run is
///   VERISQ_HARD_CASES=1000000 build/release/tests/soundness_test --gtest_filter='HardCases*'
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/fixtures/map_in_memory.hpp"
#include "tests/fixtures/requested_count.hpp"
#include "tests/oracle/random_cases.hpp"
#include "verify/proof/posed_superquadric.hpp"
#include "verify/search/convex_primitive.hpp"

namespace verisq::oracle {
namespace {

constexpr std::size_t points_a_solid = 200;
constexpr std::size_t usual_cases = 20'000;

[[nodiscard]] std::size_t requested_cases() {
  return requested_count("VERISQ_HARD_CASES", usual_cases);
}

[[nodiscard]] double hard_exponent(RandomCases& random) {
  switch (random.choice(4)) {
    case 0: return 0.05 * random.log_uniform(1.0, 2.0);
    case 1: return 2.0 - 0.05 * random.log_uniform(1.0, 2.0);
    default: return random.uniform(0.05, 1.95);
  }
}

/// Of size 1: the pose of a random solid, its own exponents and axes.
[[nodiscard]] Primitive hard_solid(RandomCases& random) {
  Primitive solid = random.solid();
  solid.superquadric.exponents = {hard_exponent(random), hard_exponent(random)};
  const double ratio = random.choice(3) == 0 ? 400.0 : random.log_uniform(1.0, 400.0);
  const double size = *std::ranges::max_element(solid.superquadric.semi_axes);
  for (double& axis : solid.superquadric.semi_axes) axis = size * std::pow(ratio, -random.uniform(0.0, 1.0));
  const std::size_t longest = random.choice(3);
  solid.superquadric.semi_axes[longest] = size;
  solid.superquadric.semi_axes[(longest + 1 + random.choice(2)) % 3] = size / ratio;
  return solid;
}

/// Proven to lie outside.
[[nodiscard]] std::vector<Point> points_outside(RandomCases& random, const Primitive& solid) {
  const verify::ConvexPrimitive posed(solid);
  std::vector<Point> points;
  while (points.size() < points_a_solid) {
    const Point q = random.point(solid).point;
    if (posed.excludes(q)) points.push_back(q);
  }
  return points;
}

struct Tally {
  std::uint64_t points = 0;
  std::uint64_t left_open = 0;  ///< by the device
  std::uint64_t closed = 0;     ///< by the host
  std::uint64_t wide = 0;
  double host_seconds = 0.0;
};

[[nodiscard]] Tally map_hard_cases(const std::string& device, std::size_t cases, bool certificates) {
  Tally tally;
  std::string name;
  for (std::size_t k = 0; k < std::max<std::size_t>(1, cases / points_a_solid); ++k) {
    RandomCases random(k);
    const Primitive solid = hard_solid(random);
    const double size = *std::ranges::max_element(solid.superquadric.semi_axes);
    MapOptions options{.tolerance = 1e-6 * size};
    options.device = device;
    options.certificates = certificates;
    const FinishedMap map = map_in_memory(Model{"", {solid}}, points_outside(random, solid), options);
    name = map.summary.device;
    tally.points += map.summary.points;
    tally.left_open += map.summary.host_verified + map.summary.wide;
    tally.closed += map.summary.host_verified;
    tally.wide += map.summary.wide;
    tally.host_seconds += map.summary.host_seconds;
    if (map.summary.wide > 0) {
      ADD_FAILURE() << fmt::format("solid {}: {} wide; exponents {} {}, semi-axes {} {} {}", k, map.summary.wide,
                                   solid.superquadric.exponents[0], solid.superquadric.exponents[1],
                                   solid.superquadric.semi_axes[0], solid.superquadric.semi_axes[1],
                                   solid.superquadric.semi_axes[2]);
    }
  }
  fmt::print("{}: {} points outside; left open {}, closed by the host {}, wide {}; host {:.3g} s\n", name, tally.points,
             tally.left_open, tally.closed, tally.wide, tally.host_seconds);
  return tally;
}

TEST(HardCasesTest, TheHostClosesWhatTheDeviceLeaves) {
  const Tally tally = map_hard_cases("auto", requested_cases(), false);
  EXPECT_EQ(tally.wide, 0U);
  EXPECT_EQ(tally.closed, tally.left_open);
}

TEST(HardCasesTest, TheHostAloneClosesEveryPoint) {
  EXPECT_EQ(map_hard_cases("host", requested_cases() / 10, false).wide, 0U);
}

TEST(HardCasesTest, CertificatesAreAsNarrow) {
  EXPECT_EQ(map_hard_cases("host", requested_cases() / 20, true).wide, 0U);
}

}  // namespace
}  // namespace verisq::oracle
