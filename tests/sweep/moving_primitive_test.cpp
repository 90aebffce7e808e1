/// Half-spaces of a moving primitive against points of it at random times.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/oracle/random_cases.hpp"
#include "verify/search/clipped_cube.hpp"

namespace verisq::verify {
namespace {

using oracle::RandomCases;

double value_at(const CuttingPlane& plane, const Point& e) {
  return plane.normal[0] * e[0] + plane.normal[1] * e[1] + plane.normal[2] * e[2];
}

/// Gauge of x in the primitive at a time of a leg.
double gauge_at(const Primitive& primitive, const EnclosedPose& pose, const Point& x) {
  const SuperquadricBounds<double> bounds(primitive.superquadric);
  const auto& t = primitive.pose.translation;  // not turned in its own frame
  Vector3<double> in_path;
  for (std::size_t i = 0; i < 3; ++i) in_path[i] = Interval(x[i]) - pose.translation[i];
  Vector3<double> own = pose.rotation.transpose() * in_path;
  for (std::size_t i = 0; i < 3; ++i) own[i] -= Interval(t[i]);
  return bounds.gauge_up(own);
}

TEST(MovingPrimitive, LiesBehindTheOuterHalfSpaceAndFillsTheInnerOne) {
  const Primitive primitive{"shaft", {{1.0, 0.6, 2.0}, {0.7, 0.9}}, {{2.0, 0.5, -1.0}}, {}};
  const std::vector<Pose> poses{{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}}, {{1.0, -2.0, 3.0}, {0.9, 0.1, -0.2, 0.5}}};
  const EnclosedPath path(poses);
  const MovingPrimitive moving(primitive, path);
  const std::vector<TimeStretch> whole = moving.whole_path();
  RandomCases random(1);
  int held = 0;
  int filled = 0;
  for (int n = 0; n < 150; ++n) {
    Cube cube{{}, n % 3 == 0 ? 1.0 : 0.25};
    // About where the primitive is at some time.
    const EnclosedPose somewhere = path.pose(0, std::round(random.uniform(0.0, 1.0) * 1024.0) / 1024.0);
    for (std::size_t i = 0; i < 3; ++i) {
      Interval at = somewhere.translation[i];
      for (std::size_t j = 0; j < 3; ++j) at += somewhere.rotation(i, j) * Interval(primitive.pose.translation[j]);
      cube.centre[i] = at.lower() + random.uniform(-1.5, 1.5);
    }
    const SweptPart part = moving.part(cube, whole);
    for (int k = 0; k < 40; ++k) {
      Point e;
      Point x;
      for (std::size_t i = 0; i < 3; ++i) {
        e[i] = random.uniform(-1.0, 1.0) * cube.half_width;
        x[i] = cube.centre[i] + e[i];
      }
      double least = 2.0;
      for (double time = 0.0; time <= 1.0; time += 0x1p-6)
        least = std::min(least, gauge_at(primitive, path.pose(0, time), x));
      if (least < 1.0) {
        ++held;
        EXPECT_FALSE(part.open.empty());
        if (part.outer) {
          EXPECT_LE(value_at(*part.outer, e), part.outer->offset + 1e-9);
        }
      }
      if (part.covered || (part.inner && value_at(*part.inner, e) < part.inner->offset - 1e-9)) {
        ++filled;
        EXPECT_LE(least, 1.1);  // at the nearest of the times looked at
      }
    }
  }
  EXPECT_GT(held, 300);
  EXPECT_GT(filled, 300);
}

}  // namespace
}  // namespace verisq::verify
