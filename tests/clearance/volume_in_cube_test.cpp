/// Volumes of cubes that half-spaces cut, against closed forms and lattices of points.
#include "verify/proof/volume_in_cube.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/oracle/random_cases.hpp"

namespace verisq::oracle {
namespace {

using verify::BracketedPart;
using verify::CornerHeights;
using verify::Interval;
using verify::PartOfCube;
using verify::volume_in_cube;

struct HalfSpaceOfCube {
  Point normal;
  double offset;  // of e in the cube |e_i| <= 1: normal·e <= offset

  [[nodiscard]] bool holds(const Point& e) const {
    return normal[0] * e[0] + normal[1] * e[1] + normal[2] * e[2] <= offset;
  }

  /// Of the cube of that half-width.
  [[nodiscard]] CornerHeights heights() const {
    CornerHeights heights;
    for (unsigned k = 0; k < 8; ++k) {
      heights[k] = Interval(-offset);
      for (unsigned i = 0; i < 3; ++i) heights[k] += Interval((k >> i & 1U) != 0 ? normal[i] : -normal[i]);
    }
    return heights;
  }
};

using Unions = std::vector<std::vector<HalfSpaceOfCube>>;

BracketedPart part_of(const Unions& unions) {
  PartOfCube part;
  for (const auto& whole : unions) {
    part.emplace_back();
    for (const HalfSpaceOfCube& one : whole) part.back().push_back(one.heights());
  }
  return {part, part};
}

/// Of the cube of half-width 1.
void expect_volume(const Unions& unions, double half_width, double exact) {
  const Enclosure found = volume_in_cube(half_width, part_of(unions));
  const double cubed = half_width * half_width * half_width;
  EXPECT_LE(found.lo, exact * cubed * (1.0 + 1e-14));
  EXPECT_GE(found.hi, exact * cubed * (1.0 - 1e-14));
  EXPECT_LE(found.width(), 1e-11 * cubed);
}

TEST(VolumeInCube, IsThatOfPrismsPyramidsAndWhatTheyLeave) {
  for (const double half_width : {0x1p-20, 1.0, 0x1p30}) {
    expect_volume({}, half_width, 8.0);
    expect_volume({{}}, half_width, 0.0);
    expect_volume({{{{1, 0, 0}, 0.5}}}, half_width, 6.0);
    expect_volume({{{{1, 0, 0}, 2.0}}}, half_width, 8.0);
    expect_volume({{{{1, 0, 0}, -1.0}}}, half_width, 0.0);
    expect_volume({{{{1, 1, 1}, -2.0}}}, half_width, 1.0 / 6.0);
    expect_volume({{{{0, 3, 4}, 0.0}}}, half_width, 4.0);
    expect_volume({{{{1, 0, 0}, 0.0}}, {{{0, 1, 0}, 0.0}}, {{{0, 0, 1}, 0.0}}}, half_width, 1.0);
    expect_volume({{{{1, 0, 0}, 0.0}, {{0, 1, 0}, 0.0}}, {{{0, 0, -1}, -0.5}}}, half_width, 1.5);
    expect_volume({{{{1, 0, 0}, 0.0}}, {{{-1, 0, 0}, 0.0}}}, half_width, 0.0);
    expect_volume({{{{1, 1, 0}, 0.25}, {{-1, -1, 0}, -0.25}}}, half_width, 8.0);
  }
}

TEST(VolumeInCube, IsWhatALatticeCounts) {
  RandomCases random(11);
  constexpr int steps = 24;
  for (int n = 0; n < 60; ++n) {
    Unions unions(1 + static_cast<std::size_t>(n) % 4);
    for (auto& whole : unions) {
      whole.resize(1 + static_cast<std::size_t>(random.uniform(0.0, 3.0)));
      for (HalfSpaceOfCube& one : whole) {
        for (double& x : one.normal) x = random.uniform(-1.0, 1.0);
        one.offset = random.uniform(-0.7, 0.7);
      }
    }
    const auto holds = [&](const Point& e) {
      return std::ranges::all_of(unions, [&](const auto& whole) {
        return std::ranges::any_of(whole, [&](const HalfSpaceOfCube& one) { return one.holds(e); });
      });
    };
    int count = 0;
    const auto at = [](int i) { return (2.0 * i + 1.0) / steps - 1.0; };
    for (int i = 0; i < steps; ++i)
      for (int j = 0; j < steps; ++j)
        for (int k = 0; k < steps; ++k) count += holds({at(i), at(j), at(k)}) ? 1 : 0;
    const Enclosure found = volume_in_cube(1.0, part_of(unions));
    EXPECT_LE(found.width(), 1e-10) << n;
    EXPECT_NEAR(found.lo, 8.0 * count / (1.0 * steps * steps * steps), 0.08) << n;
  }
}

/// What is known of a set from within alone has no volume from above, and the other way about.
TEST(VolumeInCube, LiesBetweenBothBrackets) {
  const PartOfCube half{{HalfSpaceOfCube{{1, 0, 0}, 0.0}.heights()}};
  const PartOfCube quarter{{HalfSpaceOfCube{{1, 0, 0}, -0.5}.heights()}};
  const Enclosure between = volume_in_cube(1.0, {quarter, half});
  EXPECT_NEAR(between.lo, 2.0, 1e-12);
  EXPECT_NEAR(between.hi, 4.0, 1e-12);
  BracketedPart unknown{half, half};
  leave_unknown(unknown);
  EXPECT_EQ(volume_in_cube(1.0, unknown).lo, 0.0);
  EXPECT_NEAR(volume_in_cube(1.0, unknown).hi, 4.0, 1e-12);
  leave_nothing(unknown);
  EXPECT_EQ(volume_in_cube(1.0, unknown).hi, 0.0);
}

/// Heights that are known to intervals: whatever they are.
TEST(VolumeInCube, HoldsForAllHeightsOfIntervals) {
  RandomCases random(12);
  for (int n = 0; n < 40; ++n) {
    HalfSpaceOfCube one{{random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)}, 0.1};
    const Enclosure exact = volume_in_cube(1.0, part_of({{one}}));
    CornerHeights wide = one.heights();
    for (Interval& height : wide) height += Interval(-0.01, 0.02);
    const Enclosure found = volume_in_cube(1.0, {{{wide}}, {{wide}}});
    EXPECT_LE(found.lo, exact.lo);
    EXPECT_GE(found.hi, exact.hi);
    EXPECT_GT(found.width(), 0.0);
    EXPECT_LT(found.width(), 1.0);
  }
}

}  // namespace
}  // namespace verisq::oracle
