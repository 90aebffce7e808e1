/// Cut cubes against volumes in closed form.
#include "verify/search/clipped_cube.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "tests/oracle/random_cases.hpp"

namespace verisq::verify {
namespace {

using oracle::RandomCases;

/// Of {e : n·e <= b, |e_i| <= h}, for n without zeros: the sum over the corners that lie below, each with its sign.
double volume_below(const Point& n, double b, double h) {
  long double sum = 0.0L;
  for (unsigned corner = 0; corner < 8; ++corner) {
    long double below = b;
    for (std::size_t i = 0; i < 3; ++i) below += (corner >> i & 1U) != 0 ? -std::abs(n[i]) * h : std::abs(n[i]) * h;
    const long double term = below > 0.0L ? below * below * below : 0.0L;
    sum += std::popcount(corner) % 2 == 0 ? term : -term;
  }
  return static_cast<double>(sum / (6.0L * std::abs(n[0] * n[1] * n[2])));
}

TEST(ClippedCube, OfOnePlaneIsTheSumOverCorners) {
  RandomCases random(1);
  for (int n = 0; n < 300; ++n) {
    const double h = std::exp2(random.uniform(-3.0, 3.0) > 0.0 ? 2.0 : -3.0);
    Point normal;
    for (double& x : normal) x = (random.uniform(0.0, 1.0) < 0.5 ? -1.0 : 1.0) * random.uniform(0.1, 3.0);
    const double offset = random.uniform(-8.0, 8.0) * h;
    ClippedCube cube(h);
    cube.clip({normal, offset});
    const Enclosure found = cube.volume();
    const double exact = std::clamp(volume_below(normal, offset, h), 0.0, 8.0 * h * h * h);
    EXPECT_LE(found.lo, exact + 1e-13 * h * h * h);
    EXPECT_GE(found.hi, exact - 1e-13 * h * h * h);
    EXPECT_LE(found.width(), 1e-10 * h * h * h);
  }
}

TEST(ClippedCube, AddsUpToTheWholeHoweverItIsCut) {
  RandomCases random(2);
  for (int n = 0; n < 50; ++n) {
    std::array<CuttingPlane, 3> planes;
    for (CuttingPlane& plane : planes) {
      for (double& x : plane.normal) x = random.uniform(-1.0, 1.0);
      plane.offset = random.uniform(-0.5, 0.5);
    }
    Enclosure sum{0.0, 0.0};
    for (unsigned sides = 0; sides < 8; ++sides) {
      ClippedCube cube(1.0);
      for (std::size_t k = 0; k < 3; ++k) cube.clip((sides >> k & 1U) != 0 ? opposite(planes[k]) : planes[k]);
      sum = {sum.lo + cube.volume().lo, sum.hi + cube.volume().hi};
    }
    EXPECT_LE(sum.lo, 8.0);
    EXPECT_GE(sum.hi, 8.0);
    EXPECT_LE(sum.width(), 1e-8);
  }
}

TEST(ClippedCube, OfThreePlanesAlongTheAxesIsABox) {
  ClippedCube cube(2.0);
  cube.clip({{1.0, 0.0, 0.0}, 1.0});
  cube.clip({{0.0, -2.0, 0.0}, 1.0});
  cube.clip({{0.0, 0.0, 1.0}, -2.0 + 0.25});
  EXPECT_TRUE(cube.volume().contains(3.0 * 2.5 * 0.25));
  EXPECT_LE(cube.volume().width(), 1e-9);
}

/// Normals of slivers are next to nothing: their products with coordinates below 1 underflow.
TEST(ClippedCube, IsCutByPlanesWhateverTheLengthsOfTheirNormals) {
  for (const double length : {0x1p-1074, 0x1p-1022, 1.0, 0x1p1000}) {
    ClippedCube cube(2.0);
    cube.clip({{1.0, 0.0, 0.0}, 1.0});
    cube.clip({{0.0, length, length}, 0.0});
    cube.clip({{length, 0.0, 0.0}, 0.0});
    EXPECT_TRUE(cube.volume().contains(2.0 * 4.0 * 2.0)) << length;
    cube.clip({{-length, 0.0, 0.0}, length});  // -1 <= x, of |x| <= 2
    EXPECT_TRUE(cube.volume().contains(1.0 * 4.0 * 2.0)) << length;
    EXPECT_LE(cube.volume().width(), 1e-8) << length;
  }
}

TEST(ClippedCube, KnowsWhatErrorsOfAPlaneMean) {
  ClippedCube cube(1.0);
  cube.clip({{0.0, 2.0, 0.0}, 0.5, 0.1});  // between y <= 0.2 and y <= 0.3
  EXPECT_LE(cube.volume().lo, 4.0 * 1.2);
  EXPECT_GE(cube.volume().hi, 4.0 * 1.3);
  ClippedCube nothing(1.0);
  nothing.clip({{1.0, 1.0, 1.0}, -3.0, 0.1});
  EXPECT_GT(nothing.volume().hi, 0.0);
}

TEST(ClippedCube, KeepsOrLosesAllThatLiesOnOneSide) {
  ClippedCube all(4.0);
  all.clip({{1.0, 1.0, 1.0}, 12.0});
  EXPECT_TRUE(all.volume().contains(512.0));
  all.clip({{1.0, 1.0, 1.0}, -12.0});
  EXPECT_LE(all.volume().hi, 1e-6);
}

}  // namespace
}  // namespace verisq::verify
