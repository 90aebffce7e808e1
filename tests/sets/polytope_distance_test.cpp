/// Lower bounds against points of polytopes: never above, and where the polytope is known, not below.
#include "verify/search/polytope_distance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/fixtures/random.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {
namespace {

using testing::Random;

long double dot(const Point& a, const Point& b) {
  return static_cast<long double>(a[0]) * b[0] + static_cast<long double>(a[1]) * b[1] +
         static_cast<long double>(a[2]) * b[2];
}

double distance(const Point& a, const Point& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

Point offset_of(const Point& p, const Cube& cube) {
  return {p[0] - cube.centre[0], p[1] - cube.centre[1], p[2] - cube.centre[2]};
}

bool contains(const Cube& cube, std::span<const HalfSpace> half_spaces, const Point& e) {
  return std::ranges::all_of(e, [&](double c) { return std::fabs(c) <= cube.half_width; }) &&
         std::ranges::all_of(half_spaces, [&](const HalfSpace& h) { return dot(h.normal, e) <= h.offset; });
}

/// The distance of x to the polytope by Dykstra's alternating projections.
double reference(const Point& x, const Cube& cube, std::span<const HalfSpace> half_spaces) {
  using Vector = std::array<long double, 3>;
  const Point d = offset_of(x, cube);
  Vector e{d[0], d[1], d[2]};
  std::vector<Vector> corrections(half_spaces.size() + 1, Vector{});
  for (int round = 0; round < 20000; ++round) {
    for (std::size_t j = 0; j < corrections.size(); ++j) {
      Vector y{e[0] + corrections[j][0], e[1] + corrections[j][1], e[2] + corrections[j][2]};
      Vector projected = y;
      if (j == half_spaces.size()) {
        for (long double& c : projected) c = std::clamp<long double>(c, -cube.half_width, cube.half_width);
      } else {
        const auto& [n, b] = half_spaces[j];
        const long double excess = (n[0] * y[0] + n[1] * y[1] + n[2] * y[2] - b) / dot(n, n);
        for (std::size_t i = 0; i < 3; ++i) projected[i] -= std::max(0.0L, excess) * n[i];
      }
      for (std::size_t i = 0; i < 3; ++i) corrections[j][i] = y[i] - projected[i];
      e = projected;
    }
  }
  return static_cast<double>(std::hypot(e[0] - d[0], e[1] - d[1], e[2] - d[2]));
}

TEST(PolytopeDistanceTest, OfACubeAlone) {
  const Cube cube{{1.0, 2.0, 3.0}, 0.5};
  EXPECT_DOUBLE_EQ(polytope_distance({3.0, 2.0, 3.0}, cube, {}).lower, 1.5);
  EXPECT_DOUBLE_EQ(polytope_distance({4.5, 2.0, 7.5}, cube, {}).lower, 5.0);
  EXPECT_EQ(polytope_distance({1.2, 2.2, 3.2}, cube, {}).lower, 0.0);
  EXPECT_EQ(polytope_distance({4.5, 2.0, 7.5}, cube, {}).nearest, (Point{1.5, 2.0, 3.5}));
}

TEST(PolytopeDistanceTest, OfOneHalfSpace) {
  const Cube cube{{0.0, 0.0, 0.0}, 10.0};
  const std::vector<HalfSpace> below{{{3.0, 0.0, 4.0}, 5.0}};
  const PolytopeDistance found = polytope_distance({6.0, 1.0, 8.0}, cube, below);
  EXPECT_NEAR(found.lower, 9.0, 1e-14);
  EXPECT_LE(found.lower, 9.0);
  EXPECT_NEAR(found.nearest[0], 0.6, 1e-14);
  EXPECT_NEAR(found.nearest[1], 1.0, 1e-14);
  EXPECT_NEAR(found.nearest[2], 0.8, 1e-14);
}

TEST(PolytopeDistanceTest, OfEdgesAndCorners) {
  const Cube cube{{0.0, 0.0, 0.0}, 10.0};
  const std::vector<HalfSpace> edge{{{1.0, 0.0, 0.0}, 1.0}, {{0.0, 2.0, 0.0}, 2.0}};
  EXPECT_NEAR(polytope_distance({4.0, 5.0, 6.0}, cube, edge).lower, 5.0, 1e-14);
  const std::vector<HalfSpace> corner{{{1.0, 0.0, 0.0}, 1.0}, {{0.0, 2.0, 0.0}, 2.0}, {{0.0, 0.0, 1e-9}, 1e-9}};
  EXPECT_NEAR(polytope_distance({3.0, 4.0, 7.0}, cube, corner).lower, 7.0, 1e-13);
  // Planes at an angle of 1e-3, the query in front of their common line.
  const std::vector<HalfSpace> wedge{{{1.0, 1e3, 0.0}, 0.0}, {{1.0, -1e3, 0.0}, 0.0}};
  EXPECT_NEAR(polytope_distance({2.0, 0.0, 0.0}, cube, wedge).lower, 2.0, 1e-12);
}

TEST(PolytopeDistanceTest, EmptyIsInfinitelyFar) {
  const Cube cube{{5.0, 5.0, 5.0}, 1.0};
  const std::vector<HalfSpace> beyond{{{1.0, 1.0, 1.0}, -3.0000001}};
  EXPECT_EQ(polytope_distance({0.0, 0.0, 0.0}, cube, beyond).lower, infinity);
  const std::vector<HalfSpace> touching{{{1.0, 1.0, 1.0}, -3.0}};
  EXPECT_NEAR(polytope_distance({0.0, 0.0, 0.0}, cube, touching).lower, 4.0 * std::sqrt(3.0), 1e-13);
  const std::vector<HalfSpace> apart{{{1.0, 0.2, 0.0}, -0.1}, {{-1.0, -0.2, 0.001}, 0.05}};
  EXPECT_EQ(polytope_distance({0.0, 0.0, 0.0}, cube, apart).lower, infinity);
}

TEST(PolytopeDistanceTest, SaysNothingOfUselessHalfSpaces) {
  const Cube cube{{0.0, 0.0, 0.0}, 1.0};
  const std::vector<HalfSpace> useless{
      {{0.0, 0.0, 0.0}, infinity}, {{1.0, 0.0, 0.0}, infinity}, {{infinity, 0.0, 0.0}, 1.0}, {{0.0, 0.0, 0.0}, 0.0}};
  EXPECT_DOUBLE_EQ(polytope_distance({3.0, 0.0, 0.0}, cube, useless).lower, 2.0);
}

TEST(PolytopeDistanceTest, HoldsAndIsTightForRandomPolytopes) {
  Random random(1);
  std::size_t cut = 0;
  for (int round = 0; round < 400; ++round) {
    const Cube cube{random.point(2.0), random.uniform(0.1, 1.0)};
    const Point x = random.point(4.0);
    std::vector<HalfSpace> half_spaces;
    const int count = 1 + round % 3;
    const Point feasible = random.point(0.9 * cube.half_width);
    for (int j = 0; j < count; ++j) {
      const double scale = std::exp2(random.uniform(-30.0, 30.0));
      Point n = random.point(scale);
      half_spaces.push_back({n, static_cast<double>(dot(n, feasible)) + scale * random.uniform(0.0, 0.1)});
    }
    const double exact = reference(x, cube, half_spaces);
    const PolytopeDistance found = polytope_distance(x, cube, half_spaces);
    const double without = polytope_distance(x, cube, {}).lower;
    EXPECT_LE(found.lower, exact + 1e-12);
    EXPECT_GE(found.lower, exact - 1e-6) << "round " << round << " with " << count;
    EXPECT_GE(found.lower, without - 1e-14);
    EXPECT_NEAR(distance(found.nearest, x), found.lower, 1e-6);
    cut += found.lower > without + 1e-3 ? 1 : 0;
    for (int sample = 0; sample < 200; ++sample) {
      const Point e = random.point(cube.half_width);
      if (!contains(cube, half_spaces, e)) continue;
      const Point p{cube.centre[0] + e[0], cube.centre[1] + e[1], cube.centre[2] + e[2]};
      EXPECT_LE(found.lower, distance(p, x) + 1e-14);
    }
  }
  EXPECT_GT(cut, 100U);
}

TEST(PolytopeDistanceTest, KeepsItsDigitsAtAnySize) {
  for (const double size : {1e-300, 1e-150, 1e-9, 1e9, 1e150, 1e300}) {
    const Cube cube{{0.0, 0.0, 0.0}, 10.0 * size};
    const std::vector<HalfSpace> below{{{3.0 / size, 0.0, 4.0 / size}, 5.0}};
    const double found = polytope_distance({6.0 * size, size, 8.0 * size}, cube, below).lower;
    EXPECT_NEAR(found / size, 9.0, 1e-13) << size;
    EXPECT_LE(found, 9.0 * size * (1 + 1e-15));
  }
}

TEST(PolytopeDistanceTest, ResolvesSmallCubesFromAfar) {
  const double h = 1e-10;
  const Cube cube{{1.0, 0.0, 0.0}, h};
  const std::vector<HalfSpace> half_spaces{{{-1.0, 0.3, 0.0}, -h / 2}};  // x >= 1 + h/2 + 0.3 y
  EXPECT_NEAR(polytope_distance({0.0, 0.0, 0.0}, cube, half_spaces).lower, 1.0 + 0.2 * h, 1e-15);
}

}  // namespace
}  // namespace verisq::verify
