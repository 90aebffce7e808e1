/// Ways in, and the search among them, against shadows of ellipsoids.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "tests/fixtures/error_matchers.hpp"
#include "verisq/insertion.hpp"

namespace verisq {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

constexpr double kDegree = pi / 180.0;
constexpr double kLength = 20.0;

/// Its long axis is off z by 12 degrees, towards x.
Model tilted_ellipsoid() {
  const double half = 6.0 * kDegree;
  return {"mm",
          {{"ellipsoid",
            {{1.0, 1.0, 3.0}, {1.0, 1.0}},
            {{2.0, -1.0, 0.5}, {std::cos(half), 0.0, std::sin(half), 0.0}},
            {}}},
          {}};
}

Vector3d long_axis() {
  return {std::sin(12.0 * kDegree), 0.0, std::cos(12.0 * kDegree)};
}

/// Of the ellipsoid's own volume and the prism over its shadow, which is least along the long axis.
double swept(const Point& direction) {
  const Vector3d d = Vector3d(direction[0], direction[1], direction[2]).normalized();
  const double along = d.dot(long_axis());
  const double across = std::sqrt(1.0 - along * along);
  return 4.0 * pi + kLength * pi * std::hypot(along, 3.0 * across);
}

LeastRemoval least(double cone, double tolerance) {
  const Model implant = tilted_ellipsoid();
  return least_removal({.middle = {{0.0, 0.0, 2.0}, kLength}, .cone_degrees = cone}, turning_centre(implant), implant,
                       {}, {.volume = {.relative_tolerance = tolerance}});
}

TEST(WayIn, EndsWhereTheImplantIsAndTurnsAboutTheDirection) {
  const Point centre{1.0, 2.0, 3.0};
  const std::vector<Pose> path = path_of({{0.0, 3.0, 0.0}, 10.0, 90.0}, centre);
  ASSERT_GT(path.size(), 45U);
  EXPECT_EQ(path.back().translation, (Point{0.0, 0.0, 0.0}));
  EXPECT_EQ(path.back().quaternion, (std::array{1.0, 0.0, 0.0, 0.0}));
  for (std::size_t k = 0; k < path.size(); ++k) {
    const auto& [w, x, y, z] = path[k].quaternion;
    const auto& t = path[k].translation;
    const Eigen::Quaterniond turn(w, x, y, z);
    const double left = 1.0 - static_cast<double>(k) / static_cast<double>(path.size() - 1);
    const Vector3d of_centre = turn * Vector3d(1.0, 2.0, 3.0) + Vector3d(t[0], t[1], t[2]);
    EXPECT_LT((of_centre - Vector3d(1.0, 2.0 - 10.0 * left, 3.0)).norm(), 1e-12);
    // Right-handed about y on the way: from z towards x, and not there yet.
    const Vector3d of_z = turn * Vector3d::UnitZ();
    EXPECT_LT((of_z - Vector3d(-std::sin(left * pi / 2), 0.0, std::cos(left * pi / 2))).norm(), 1e-12);
  }
}

TEST(WayIn, WithoutATurnIsStraight) {
  EXPECT_EQ(path_of({{0.0, 0.0, -2.0}, 5.0}, {1.0, 2.0, 3.0}).size(), 2U);
  EXPECT_EQ(path_of({{0.0, 0.0, -2.0}, 5.0}, {1.0, 2.0, 3.0})[0].translation, (Point{0.0, 0.0, 5.0}));
}

TEST(LeastRemoval, FindsTheDirectionOfTheSmallestShadow) {
  const LeastRemoval found = least(20.0, 0.15);
  const Point& d = found.way.direction;
  const double off = std::acos(Vector3d(d[0], d[1], d[2]).normalized().dot(long_axis())) / kDegree;
  EXPECT_LT(off, 5.0);  // there the shadow is at most 3 % larger than the least
  EXPECT_LE(found.removed.volume.lo, swept(d));
  EXPECT_GE(found.removed.volume.hi, swept(d));
  EXPECT_LE(found.removed.volume.width(), 0.15 * found.removed.volume.lo);
  EXPECT_TRUE(found.removed.within_tolerance);
  EXPECT_LE(found.of_middle.lo, swept({0.0, 0.0, 1.0}));
  EXPECT_GE(found.of_middle.hi, swept({0.0, 0.0, 1.0}));
  EXPECT_LT(found.removed.volume.hi, found.of_middle.lo);
  EXPECT_GT(found.tried, 40U);
  EXPECT_GT(found.worse, found.tried / 6);
  ASSERT_EQ(found.path.size(), 2U);
  EXPECT_EQ(found.path[0].translation, path_of(found.way, {})[0].translation);
}

TEST(LeastRemoval, StaysInTheCone) {
  const Point d = least(5.0, 0.7).way.direction;
  EXPECT_LE(std::acos(Vector3d(d[0], d[1], d[2]).normalized()[2]) / kDegree, 5.0 + 1e-9);
}

TEST(LeastRemoval, RefusesWhatIsNoFamily) {
  const auto refused = [](WaysIn ways, const char* why) {
    testing::expect_error([&] { (void)least_removal(ways, {}, tilted_ellipsoid(), {}, {}); }, ErrorKind::input, why,
                          "");
  };
  const WayIn middle{{0.0, 0.0, 1.0}, 1.0};
  refused({middle, 0.0, 0.0}, "ways in: with neither a cone nor turns there is one way");
  refused({middle, 81.0, 0.0}, "ways in: a cone of 81 degrees is not between 0 and 80");
  refused({middle, 1.0, -1.0}, "ways in: turns by -1 degrees are not between 0 and 180");
  refused({{{0.0, 0.0, 1.0}, 1.0, 300.0}, 1.0, 61.0}, "ways in: turns by up to 361 degrees are beyond 360");
  refused({{{0.0, 0.0, 0.0}, 1.0}, 1.0, 0.0}, "way in: its direction is not finite, or zero");
  refused({{{0.0, 0.0, 1.0}, 0.0}, 1.0, 0.0}, "way in: length 0 is not a number above 0");
}

}  // namespace
}  // namespace verisq
