/// Distances of points from triangles, slivers and points among them, against long double.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/deviation/brute_force.hpp"
#include "tests/fixtures/random.hpp"
#include "verify/proof/triangle_tree.hpp"

namespace verisq::verify {
namespace {

using testing::distance_to_triangle;
using testing::Long;
using testing::Random;

Triangle random_triangle(Random& random, int n) {
  Triangle triangle{random.point(1.0), random.point(1.0), random.point(1.0)};
  const double thinness = std::pow(10.0, random.uniform(-12.0, 0.0));
  if (n % 4 == 1) {  // a needle
    for (std::size_t i = 0; i < 3; ++i) triangle[2][i] = triangle[0][i] + thinness * triangle[2][i];
  } else if (n % 4 == 2) {  // three corners about a line
    const double share = random.uniform(-1.0, 2.0);
    for (std::size_t i = 0; i < 3; ++i) {
      triangle[2][i] = triangle[0][i] + share * (triangle[1][i] - triangle[0][i]) + thinness * triangle[2][i];
    }
  } else if (n % 4 == 3) {
    triangle[1] = triangle[0];
    if (n % 8 == 3) triangle[2] = triangle[0];
  }
  return triangle;
}

TEST(TriangleDistanceBounds, ContainTheDistance) {
  Random random(1);
  int tight = 0;
  constexpr int cases = 20000;
  for (int n = 0; n < cases; ++n) {
    const Triangle triangle = random_triangle(random, n);
    const Point point = random.point(n % 3 == 0 ? 100.0 : 1.5);
    const Enclosure found = distance_from_triangle(point, triangle);
    const Long exact = distance_to_triangle(point, triangle);
    ASSERT_LE(found.lo, exact * (1 + 1e-17L)) << n;
    ASSERT_GE(found.hi, exact * (1 - 1e-17L)) << n;
    if (found.width() <= 1e-9 * found.hi) ++tight;
  }
  EXPECT_GE(tight, cases * 99 / 100);
}

/// Of the second corner the products are infinite, of both signs: their sum says nothing, and must not be forgotten.
/// The side from the first corner to the second comes as near as 1.5e120/√1.25.
TEST(TriangleDistanceBounds, BeyondBinary64NothingIsKnown) {
  const Triangle triangle{{{-1e120, -1e120, -1.0}, {1e200, -0.5e200, 0.0}, {-1e120, -1e120, 1.0}}};
  const Enclosure found = distance_from_triangle({0.0, 0.0, 0.0}, triangle);
  EXPECT_LE(found.lo, 1.35e120);
  EXPECT_GE(found.hi, 1.34e120);
}

TEST(TriangleDistanceBounds, OfPointsOnTheTriangleAreNext0) {
  Random random(2);
  for (int n = 0; n < 500; ++n) {
    const Triangle triangle{random.point(1.0), random.point(1.0), random.point(1.0)};
    for (const Point& point : testing::grid_on(triangle, 3)) {
      EXPECT_LE(distance_from_triangle(point, triangle).hi, 1e-13);
    }
  }
}

TEST(TriangleDistanceBounds, OfHugeNumbersAreNoLie) {
  const Triangle huge{Point{-1e300, 0, 0}, Point{1e300, 0, 0}, Point{0, 1e300, 0}};
  const Enclosure found = distance_from_triangle({0, 0, 5}, huge);
  EXPECT_LE(found.lo, 5.0);
  EXPECT_GE(found.hi, 5.0);
}

TEST(TriangleTree, FindsTheNearestOfAll) {
  Random random(3);
  std::vector<Triangle> triangles;
  for (int n = 0; n < 300; ++n) {
    Triangle triangle = random_triangle(random, n);
    for (Point& corner : triangle) {
      for (double& x : corner) x = 0.1 * x + random.uniform(-0.01, 0.01);
    }
    const Point shift = random.point(1.0);
    for (Point& corner : triangle) {
      for (std::size_t i = 0; i < 3; ++i) corner[i] += shift[i];
    }
    triangles.push_back(triangle);
  }
  const TriangleTree tree(triangles);
  for (int n = 0; n < 500; ++n) {
    const Point point = random.point(1.5);
    Long exact = HUGE_VALL;
    for (const Triangle& triangle : triangles) exact = std::min(exact, distance_to_triangle(point, triangle));
    const TriangleTree::Nearest found = tree.nearest(point);
    ASSERT_LE(found.distance.lo, exact * (1 + 1e-17L));
    ASSERT_GE(found.distance.hi, exact * (1 - 1e-17L));
    EXPECT_LE(distance_to_triangle(point, tree.triangle(found.triangle)), found.distance.hi * (1 + 1e-15L));
    EXPECT_LE(found.distance.width(), 1e-9);
  }
}

TEST(PolygonDistance, BoundsThatOfEveryPointAndIsTightOverManyTriangles) {
  // A wavy sheet, and triangles a little above it.
  Mesh sheet;
  constexpr std::uint32_t side = 12;
  for (std::uint32_t i = 0; i <= side; ++i) {
    for (std::uint32_t j = 0; j <= side; ++j)
      sheet.vertices.push_back({i * 0.1, j * 0.1, 0.01 * std::sin(i + 2.0 * j)});
  }
  for (std::uint32_t i = 0; i < side; ++i) {
    for (std::uint32_t j = 0; j < side; ++j) {
      const std::uint32_t a = i * (side + 1) + j;
      sheet.triangles.push_back({a, a + side + 1, a + side + 2});
      sheet.triangles.push_back({a, a + side + 2, a + 1});
    }
  }
  const TriangleTree tree(triangles_of(sheet));
  Random random(4);
  int tight = 0;
  constexpr int cases = 60;
  for (int n = 0; n < cases; ++n) {
    const Point middle{random.uniform(0.3, 0.9), random.uniform(0.3, 0.9), random.uniform(0.02, 0.05)};
    Triangle triangle{};
    for (Point& corner : triangle) {
      const Point off = random.point(1.0);
      corner = {middle[0] + 0.06 * off[0], middle[1] + 0.06 * off[1], middle[2] + 0.002 * off[2]};
    }
    Long exact = 0;
    for (const Point& point : testing::grid_on(triangle, 8)) {
      exact = std::max(exact, testing::distance_to_mesh(point, sheet));
    }
    const double enough = static_cast<double>(exact) * 1.1;
    const double bound = farthest_of_polygon(triangle, tree, tree.nearest(triangle[0]).triangle, enough);
    ASSERT_GE(bound, exact) << n;
    if (bound <= enough) ++tight;
  }
  EXPECT_GE(tight, cases * 8 / 10);
}

}  // namespace
}  // namespace verisq::verify
