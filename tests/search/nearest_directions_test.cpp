/// Covers of directions: they hold of boxes that have the nearest points, and of no others.
#include <gtest/gtest.h>

#include "verify/search/convex_primitive.hpp"

namespace verisq::verify {
namespace {

PreciseVector box(double x, double y, double z, double half) {
  const auto about = [half](double c) { return PreciseInterval(Real(c - half), Real(c + half)); };
  return {about(x), about(y), about(z)};
}

bool covered(const Superquadric& solid, const PreciseVector& q, double depth, const PreciseVector& box) {
  const SuperquadricBounds<Real> bounds(solid);
  return nearest_points_lie_in(solid, bounds, q, PreciseInterval(Real(depth - 1e-9), Real(depth + 1e-9)), box);
}

const Superquadric ball{{1.0, 1.0, 1.0}, {1.0, 1.0}};
const Superquadric plate{{4.0, 3.0, 1.0}, {0.5, 0.5}};

TEST(NearestDirections, LeadToTheNearestPoint) {
  const PreciseVector q = box(0.0, 0.0, 0.5, 0.0);
  EXPECT_TRUE(covered(ball, q, 0.5, box(0.0, 0.0, 1.0, 0.1)));
  EXPECT_FALSE(covered(ball, q, 0.5, box(0.3, 0.0, 1.0, 0.1)));
  EXPECT_FALSE(covered(ball, q, 0.75, box(0.0, 0.0, 1.0, 0.1)));  // nearer ones are forgotten, farther ones found
}

TEST(NearestDirections, LeadEverywhereFromTheMiddleOfABall) {
  EXPECT_FALSE(covered(ball, box(0.0, 0.0, 0.0, 0.0), 1.0, box(0.0, 0.0, 1.0, 0.5)));
  EXPECT_TRUE(covered(ball, box(0.0, 0.0, 0.0, 0.0), 1.0, box(0.0, 0.0, 0.0, 2.0)));
}

/// From the middle plane both faces are as near, and the box must hold both.
TEST(NearestDirections, LeadToMirrorImagesFromAPlaneOfSymmetry) {
  const PreciseVector q = box(0.25, 0.25, 0.0, 0.0);
  EXPECT_FALSE(covered(plate, q, 1.0, box(0.25, 0.25, 1.0, 0.9)));
  EXPECT_TRUE(covered(plate, q, 1.0, box(0.25, 0.25, 0.0, 2.0)));
  EXPECT_TRUE(covered(plate, box(0.25, 0.25, 0.5, 0.0), 0.5, box(0.25, 0.25, 1.0, 0.9)));
}

}  // namespace
}  // namespace verisq::verify
