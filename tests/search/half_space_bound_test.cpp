/// No point of a triangle lies deeper than half-spaces say, and hardly any triangle nearly as deep.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/fixtures/random.hpp"
#include "verify/search/set_tree.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"

namespace verisq {
namespace {

using verisq::testing::Random;

Primitive random_primitive(Random& random, double apart) {
  Superquadric solid{{random.uniform(0.5, 1.5), random.uniform(0.5, 1.5), random.uniform(0.5, 1.5)},
                     {random.uniform(0.1, 1.9), random.uniform(0.1, 1.9)}};
  if (random.uniform(0.0, 1.0) < 0.4) solid.taper = random.uniform(0.4, 2.5);
  Primitive primitive{"", solid, {random.point(apart)}, {}};
  for (double& q : primitive.pose.quaternion) q = random.uniform(-1.0, 1.0);
  return primitive;
}

Triangle random_triangle(Random& random, double reach, double size) {
  const Point centre = random.point(reach);
  Triangle triangle;
  for (Point& corner : triangle) {
    const Point step = random.point(size);
    for (std::size_t i = 0; i < 3; ++i) corner[i] = centre[i] + step[i];
  }
  return triangle;
}

/// Corners, and some others.
std::vector<Point> points_of(const Triangle& triangle) {
  constexpr int divisions = 4;
  std::vector<Point> points;
  for (int a = 0; a <= divisions; ++a) {
    for (int b = 0; a + b <= divisions; ++b) {
      Point point;
      for (std::size_t i = 0; i < 3; ++i) {
        const double rest = divisions - a - b;
        point[i] = (a * triangle[0][i] + b * triangle[1][i] + rest * triangle[2][i]) / divisions;
      }
      points.push_back(point);
    }
  }
  return points;
}

TEST(HalfSpaceBound, IsNoMoreThanTheDistanceOfAnyPoint) {
  Random random(3);
  int bounded = 0;
  for (int i = 0; i < 60; ++i) {
    Model model{"", {random_primitive(random, 1.0), random_primitive(random, 1.0)}, {}};
    if (i % 2 == 0) model.primitives.push_back(random_primitive(random, 2.0));
    const verify::HalfSpaceBound bound(model);
    const SignedDistance distance(model);
    for (int k = 0; k < 6; ++k) {
      const Triangle triangle = random_triangle(random, 1.6, k < 3 ? 0.05 : 0.6);
      const double lower = bound(triangle);
      if (lower > -infinity) ++bounded;
      for (const Point& point : points_of(triangle))
        ASSERT_LE(lower, distance(point, 1e-9).hi + 1e-12) << i << " " << k;
    }
  }
  EXPECT_GT(bounded, 150);
}

/// Of one primitive the bound is off by the order of the square of the triangle's size.
TEST(HalfSpaceBound, IsCloseForSmallTriangles) {
  Random random(4);
  int close = 0;
  int all = 0;
  for (int i = 0; i < 40; ++i) {
    const Model model{"", {random_primitive(random, 0.0)}, {}};
    const verify::HalfSpaceBound bound(model);
    const SignedDistance distance(model);
    for (int k = 0; k < 4; ++k) {
      const Triangle triangle = random_triangle(random, 1.0, 0.01);
      double least = infinity;
      for (const Point& point : points_of(triangle)) least = std::min(least, distance(point, 1e-9).lo);
      ++all;
      if (bound(triangle) >= least - 1e-3) ++close;
    }
  }
  EXPECT_GT(close, 9 * all / 10);
}

/// Where two balls overlap a point may lie deeper than in each of them.
TEST(HalfSpaceBound, SaysNothingInOverlaps) {
  const auto ball = [](double x) { return Primitive{"", {{1, 1, 1}, {1, 1}}, {{x, 0, 0}}, {}}; };
  const verify::HalfSpaceBound bound({"", {ball(-0.6), ball(0.6)}, {}});
  EXPECT_EQ(bound({{{0.0, 0.0, 0.0}, {0.01, 0.0, 0.0}, {0.0, 0.01, 0.0}}}), -infinity);
  EXPECT_NEAR(bound({{{-1.5, 0.0, 0.0}, {-1.5, 0.01, 0.0}, {-1.5, 0.0, 0.01}}}), -0.1, 1e-3);
  EXPECT_NEAR(bound({{{0.0, 2.0, 0.0}, {0.0, 2.01, 0.0}, {0.0, 2.0, 0.01}}}), std::hypot(0.6, 2.0) - 1.0, 1e-3);
}

}  // namespace
}  // namespace verisq
