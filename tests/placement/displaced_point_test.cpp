/// Places of a point under uncertain motions, of all sizes that binary64 has, against places in long double.
#include "verify/search/displaced_point.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tests/oracle/random_cases.hpp"

namespace verisq::verify {
namespace {

using Vector = std::array<long double, 3>;

long double dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Vector wide(const Point& p) {
  return {p[0], p[1], p[2]};
}

/// The inverse of the rotation about the axis by the angle, of arm - shift (Rodrigues).
Vector turned_back(const Vector& v, const Vector& axis, long double angle) {
  const Vector across = cross(axis, v);
  const Vector twice = cross(axis, across);
  Vector result;
  for (std::size_t i = 0; i < 3; ++i)
    result[i] = v[i] - std::sin(angle) * across[i] + (1.0L - std::cos(angle)) * twice[i];
  return result;
}

struct Case {
  PoseUncertainty bounds;
  Point point;
};

/// `size` times numbers about 1; of every third the point is the centre itself.
Case random_case(oracle::RandomCases& random, double size, int n) {
  Case result{};
  const double shift = n % 2 == 0 ? 0.0 : random.uniform(0.0, 0.3);
  result.bounds.rotation = std::exp2(random.uniform(-20.0, 2.0));
  for (std::size_t i = 0; i < 3; ++i) {
    result.bounds.centre[i] = n % 4 < 2 ? 0.0 : size * random.uniform(-1.0, 1.0);
    result.bounds.translation[i] = size * shift * random.uniform(0.0, 1.0);
    const double apart = n % 3 == 0 ? 0.0 : size * random.uniform(-1.0, 1.0);
    result.point[i] = result.bounds.centre[i] + apart;
  }
  return result;
}

/// The farthest corner in a direction, and how far beyond it a place may lie.
long double reach_of_cover(const std::vector<Point>& corners, double error, const Vector& direction) {
  long double farthest = -INFINITY;
  for (const Point& corner : corners) farthest = std::max(farthest, dot(wide(corner), direction));
  return farthest + error;
}

class PlacesOfSize : public testing::TestWithParam<double> {};

TEST_P(PlacesOfSize, LieInTheCoverTheBoxAndTheBall) {
  const double size = GetParam();
  oracle::RandomCases random(7);
  for (int n = 0; n < 60; ++n) {
    const auto [bounds, point] = random_case(random, size, n);
    const DisplacedPoint places(bounds, point);
    std::vector<Point> corners;
    places.append_cover(corners);
    ASSERT_EQ(corners.size(), DisplacedPoint::cover_size);
    for (const Point& corner : corners)
      for (const double c : corner) ASSERT_TRUE(std::isfinite(c)) << n;
    for (int k = 0; k < 20; ++k) {
      Vector arm;
      for (std::size_t i = 0; i < 3; ++i) {
        const long double shift = (k % 2 == 0 ? 1.0 : random.uniform(-1.0, 1.0)) * bounds.translation[i];
        arm[i] = static_cast<long double>(point[i]) - bounds.centre[i] - shift;
      }
      const Vector axis = wide(random.direction());
      const long double angle = std::min(bounds.rotation, 3.14) * (k % 3 == 0 ? 1.0L : random.uniform(0.0, 1.0));
      const Vector back = turned_back(arm, axis, angle);
      Vector place;
      Vector moved;
      for (std::size_t i = 0; i < 3; ++i) {
        place[i] = back[i] + bounds.centre[i];
        moved[i] = place[i] - point[i];
        EXPECT_LE(std::abs(moved[i]), places.half_extent()[i] * (1.0L + 1e-12L)) << n;
      }
      EXPECT_LE(std::sqrt(dot(moved, moved)), places.reach() * (1.0L + 1e-12L)) << n;
      const Vector direction = k % 4 == 0 ? moved : wide(random.direction());
      const long double length = std::sqrt(dot(direction, direction));
      if (!(length > 0.0L)) continue;
      const Vector unit{direction[0] / length, direction[1] / length, direction[2] / length};
      EXPECT_LE(dot(place, unit), reach_of_cover(corners, places.cover_error(), unit)) << n << " " << k;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, PlacesOfSize,
                         testing::Values(0x1p-1060, 1e-300, 1e-200, 1e-162, 1e-155, 1.0, 1e150, 1e200, 1e300));

/// Far more than what binary64 loses of 1 would be no cover of what is small.
TEST(DisplacedPoint, IsCoveredClosely) {
  for (const double size : {1e-300, 1e-162, 1.0, 1e150, 1e300}) {
    const DisplacedPoint places({.translation = {}, .rotation = 1e-3, .centre = {}}, {0.0, 0.0, size});
    EXPECT_LE(places.reach(), 1.001e-3 * size);
    EXPECT_LE(places.cover_error(), 1e-7 * size);
    std::vector<Point> corners;
    places.append_cover(corners);
    for (const Point& corner : corners) {
      EXPECT_LE(std::hypot(corner[0], corner[1]), 1.1e-3 * size);
      EXPECT_LE(std::abs(corner[2] - size), 1e-6 * size);
    }
  }
}

}  // namespace
}  // namespace verisq::verify
