/// Moved models: their numbers against MPFR with 100 digits, their distances against those of points moved back.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/multiprecision/mpfr.hpp>
#include <cmath>
#include <vector>
#include <verisq/error.hpp>

#include "tests/oracle/random_cases.hpp"
#include "verisq/distance.hpp"

namespace verisq::oracle {
namespace {

using Number =
    boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<100>, boost::multiprecision::et_off>;
using Vector = std::array<Number, 3>;
using Quaternion = std::array<Number, 4>;

Vector exact(const Point& x) {
  return {x[0], x[1], x[2]};
}

Quaternion normalised(const Quaternion& q) {
  const Number length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  return {q[0] / length, q[1] / length, q[2] / length, q[3] / length};
}

Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// x + 2 w (v × x) + 2 v × (v × x) with the unit quaternion (w, v): no matrix, unlike what is tested.
Vector rotated(const Quaternion& quaternion, const Vector& x) {
  const Quaternion q = normalised(quaternion);
  const Vector v{q[1], q[2], q[3]};
  const Vector once = cross(v, x);
  const Vector twice = cross(v, once);
  Vector y;
  for (std::size_t i = 0; i < 3; ++i) y[i] = x[i] + 2 * q[0] * once[i] + 2 * twice[i];
  return y;
}

Quaternion exact(const std::array<double, 4>& q) {
  return {q[0], q[1], q[2], q[3]};
}

Vector moved(const Pose& pose, const Vector& x) {
  Vector y = rotated(exact(pose.quaternion), x);
  for (std::size_t i = 0; i < 3; ++i) y[i] += pose.translation[i];
  return y;
}

Point nearest(const Vector& x) {
  return {x[0].convert_to<double>(), x[1].convert_to<double>(), x[2].convert_to<double>()};
}

double largest_difference(const Vector& a, const Vector& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Number difference = abs(a[i] - b[i]);
    largest = std::max(largest, difference.convert_to<double>());
  }
  return largest;
}

/// Quaternions of lengths from 1e-150 to 1e150.
Pose random_pose(RandomCases& random) {
  Pose pose = random.solid().pose;
  const double length = random.log_uniform(1e-150, 1e150);
  for (double& element : pose.quaternion) element *= length;
  return pose;
}

const Model two_bodies{
    .units = "mm",
    .primitives = {{"body", {{2.0, 3.0, 9.0}, {0.7, 0.9}}, {{1.0, -2.0, 3.0}, {0.6, 0.0, 0.0, -0.8}}, Bend{0.02, 30.0}},
                   {"bore", {{1.0, 1.0, 12.0}, {0.3, 1.0}}, {{0.0, 0.0, 1.0}, {5.0, 1.0, 2.0, 0.1}}, {}}},
    .csg = SetExpression{.operands = {{.primitive = 0}, {.primitive = 1}}, .operation = SetOperation::subtract}};

TEST(PosedModel, KeepsAllButThePoses) {
  const Model moved = posed(two_bodies, {{1.0, 2.0, 3.0}, {0.1, 0.2, -0.3, 0.4}});
  EXPECT_EQ(moved.units, "mm");
  ASSERT_EQ(moved.primitives.size(), 2U);
  for (std::size_t n = 0; n < 2; ++n) {
    EXPECT_EQ(moved.primitives[n].name, two_bodies.primitives[n].name);
    EXPECT_EQ(moved.primitives[n].superquadric.semi_axes, two_bodies.primitives[n].superquadric.semi_axes);
    EXPECT_EQ(moved.primitives[n].superquadric.exponents, two_bodies.primitives[n].superquadric.exponents);
    EXPECT_NE(moved.primitives[n].pose.translation, two_bodies.primitives[n].pose.translation);
  }
  ASSERT_TRUE(moved.primitives[0].bend);
  EXPECT_EQ(moved.primitives[0].bend->curvature, 0.02);
  EXPECT_EQ(moved.primitives[0].bend->angle_degrees, 30.0);
  EXPECT_FALSE(moved.primitives[1].bend);
  ASSERT_TRUE(moved.csg);
  EXPECT_EQ(moved.csg->operation, SetOperation::subtract);
  EXPECT_EQ(moved.csg->operands.size(), 2U);
}

TEST(PosedModel, IsTheModelUpToNormalisationForTheIdentity) {
  RandomCases random(1);
  for (int n = 0; n < 200; ++n) {
    const Pose pose = random_pose(random);
    const Pose moved = posed({"", {{"", {{1, 1, 1}, {1, 1}}, pose, {}}}}, {}).primitives[0].pose;
    EXPECT_EQ(moved.translation, pose.translation);
    const Quaternion unit = normalised(exact(pose.quaternion));
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(moved.quaternion[i], unit[i].convert_to<double>());
  }
}

TEST(PosedModel, ComposesPosesToNearest) {
  RandomCases random(2);
  for (int n = 0; n < 500; ++n) {
    const Pose inner = random_pose(random);
    const Pose outer = random_pose(random);
    const Pose both = posed({"", {{"", {{1, 1, 1}, {1, 1}}, inner, {}}}}, outer).primitives[0].pose;
    EXPECT_EQ(both.translation, nearest(moved(outer, exact(inner.translation))));
    const Quaternion q = exact(both.quaternion);
    const Number square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    EXPECT_NEAR(square.convert_to<double>(), 1.0, 0x1p-51);
    const Vector x = exact(random.direction());
    const Vector expected = rotated(exact(outer.quaternion), rotated(exact(inner.quaternion), x));
    // Four elements, each half a unit in the last place off, turn a vector by at most 2^-51 and a little.
    EXPECT_LE(largest_difference(rotated(q, x), expected), 0x1p-50);
  }
}

TEST(PosedModel, OfBoundsMovesAsTheModelBetweenThemDoes) {
  const Pose pose{{1.0, 2.0, 3.0}, {0.1, 0.2, -0.3, 0.4}};
  UncertainModel bounds(two_bodies);
  bounds.primitives[0].semi_axes[0] = {1.5, 2.5};
  const UncertainModel moved = posed(bounds, pose);
  const UncertainModel expected(posed(two_bodies, pose));
  EXPECT_EQ(moved.primitives[0].semi_axes[0], (Enclosure{1.5, 2.5}));
  for (std::size_t n = 0; n < 2; ++n) {
    EXPECT_EQ(moved.primitives[n].translation, expected.primitives[n].translation);
    EXPECT_EQ(moved.primitives[n].quaternion, expected.primitives[n].quaternion);
  }
}

TEST(PosedModel, DoesNotTurnBoxesOfPlaces) {
  UncertainModel bounds(two_bodies);
  bounds.primitives[1].translation[2] = {0.0, 0.5};
  EXPECT_THROW(static_cast<void>(posed(bounds, {})), Error);
}

TEST(PosedModel, HasTheDistancesOfThePointsMovedBack) {
  RandomCases random(3);
  Model model = two_bodies;
  model.csg.reset();
  model.primitives[0].bend.reset();
  for (int n = 0; n < 20; ++n) {
    const Pose pose{{random.uniform(-30, 30), random.uniform(-30, 30), random.uniform(-30, 30)},
                    {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}};
    const SignedDistance distance(model);
    const SignedDistance moved_distance(posed(model, pose));
    for (int k = 0; k < 10; ++k) {
      const Point x{random.uniform(-10, 10), random.uniform(-10, 10), random.uniform(-15, 15)};
      const Enclosure here = distance(x, 1e-6);
      const Enclosure there = moved_distance(nearest(moved(pose, exact(x))), 1e-6);
      const double rounding = 1e-13;  // of numbers to 50
      EXPECT_LE(here.lo, there.hi + rounding);
      EXPECT_LE(there.lo, here.hi + rounding);
    }
  }
}

TEST(PosedModel, MovesNamedPointsAsItsPrimitives) {
  const Pose pose{.translation = {3.0, -1.0, 0.5}, .quaternion = {0.9, 0.1, -0.3, 0.2}};
  const Point at{19.3, 11.4, 85.3};
  const Model moved_model = posed(Model{"mm", {{"head", {{1, 1, 1}, {1, 1}}, {at}}}, {}}, pose);
  const FemurLandmarks landmarks = posed(FemurLandmarks{.head_centre = at, .head_radius = 14.0}, pose);
  EXPECT_EQ(landmarks.head_centre, moved_model.primitives[0].pose.translation);
  EXPECT_EQ(landmarks.head_radius, 14.0);
  EXPECT_FALSE(landmarks.neck_centre);
}

}  // namespace
}  // namespace verisq::oracle
