/// How far the points of a solid are from a centre, from above: never too little, and exact for ellipsoids.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/oracle/random_cases.hpp"
#include "verify/search/solid_pair_distance.hpp"

namespace verisq::verify {
namespace {

using oracle::RandomCases;

double apart(const Point& x, const Point& y) {
  return std::hypot(x[0] - y[0], x[1] - y[1], x[2] - y[2]);
}

TEST(FarthestPointTest, NoPointIsFarther) {
  RandomCases cases(81);
  for (int trial = 0; trial < 200; ++trial) {
    const Superquadric solid{{cases.uniform(0.3, 2.0), cases.uniform(0.3, 2.0), cases.uniform(0.3, 2.0)},
                             {cases.uniform(0.1, 2.0), cases.uniform(0.1, 2.0)}};
    const Primitive primitive = cases.solid(solid);
    const BoundedMotion motion(primitive.pose);
    Point x = primitive.pose.translation;
    for (double& c : x) c += cases.uniform(-3.0, 3.0);
    const double bound = farthest_up(primitive, x);
    double farthest = 0.0;
    for (int i = 0; i < 2000; ++i)
      farthest = std::max(farthest, apart(x, motion.to_a(cases.boundary_point(solid).point)));
    EXPECT_LE(farthest, bound * (1.0 + 1e-12)) << "trial " << trial;
    const double loosest = std::sqrt(2.0) * std::sqrt(2.0) + 1e-9;  // of the norms in one another, by the semi-axes
    EXPECT_LE(bound, loosest * (farthest + apart(x, primitive.pose.translation)) + 0.1);
  }
}

TEST(FarthestPointTest, ExactForEllipsoids) {
  const Primitive ellipsoid{"", {{16.0, 15.9, 15.8}, {1.0, 1.0}}, {{1.0, 2.0, 3.0}, {1, 0, 0, 0}}};
  EXPECT_NEAR(farthest_up(ellipsoid, {1.0, 2.0, 3.0}), 16.0, 1e-12);
  EXPECT_NEAR(farthest_up(ellipsoid, {0.0, 2.0, 3.0}), 17.0, 1e-12);
  EXPECT_NEAR(farthest_up(ellipsoid, {6.0, 2.0, 3.0}), 21.0, 1e-12);
  EXPECT_NEAR(farthest_up(ellipsoid, {1.0, 12.0, 3.0}), 25.9, 1e-12);
  // On the short axis, near the centre: the farthest points are a circle off the tip, by |x|² = Σ of both coordinates.
  const Primitive disc{"", {{2.0, 2.0, 1.0}, {1.0, 1.0}}, {}};
  // x² + (z + 1)² with x² = 4 (1 - z²) is largest at z = 1/3: 4 + 4/3.
  EXPECT_NEAR(farthest_up(disc, {0.0, 0.0, -1.0}), std::sqrt(4.0 + 4.0 / 3.0), 1e-12);
}

TEST(FarthestPointTest, BentAndTaperedSolidsAreNotBounded) {
  EXPECT_EQ(farthest_up({"", {{1, 1, 1}, {1, 1}}, {}, Bend{0.1, 0.0}}, {}), infinity);
  EXPECT_EQ(farthest_up({"", {{1, 1, 1}, {1, 1}, 2.0}, {}}, {}), infinity);
}

TEST(HollowsTest, AreBallsThatSetOperationsTakeAway) {
  const Superquadric ball{{2.0, 2.0, 2.0}, {1.0, 1.0}};
  const SetExpression a{{}, SetOperation::unite, 0};
  const SetExpression b{{}, SetOperation::unite, 1};
  const SetExpression c{{}, SetOperation::unite, 2};
  const Model cup{
      "",
      {{"a", {{9, 9, 9}, {1, 1}}, {}}, {"b", ball, {{1, 2, 3}, {1, 0, 0, 0}}}, {"c", {{2, 2, 1}, {1, 1}}, {}}},
      SetExpression{{a, b, c}, SetOperation::subtract}};
  const std::vector<Ball> found = hollows(cup);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].centre, (Point{1, 2, 3}));
  EXPECT_EQ(found[0].radius, 2.0);
}

}  // namespace
}  // namespace verisq::verify
