/// Boxes of poses: where points get to, against poses sampled within the boxes.
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <random>

#include "verify/search/distance_field.hpp"

namespace verisq::verify {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kSize = 1e3;
const double kRounding = PoseBoxMotion::rounding(kSize);

class Samples {
 public:
  double uniform(double reach) { return reach * distribution_(random_); }
  Vector3d vector(double reach) { return {uniform(reach), uniform(reach), uniform(reach)}; }

  /// Any point of the box, every other time a corner.
  PoseParameters of(const PoseBox& box) {
    PoseParameters result;
    const bool corner = uniform(1.0) > 0.0;
    for (int i = 0; i < 6; ++i) {
      const double share = uniform(1.0);
      result[i] = box.centre[i] + (corner ? std::copysign(1.0, share) : share) * box.half[i];
    }
    return result;
  }

  PoseBox box(double translation, double rotation) {
    PoseBox result;
    result.centre << vector(20.0), vector(2.0);
    result.half << vector(translation).cwiseAbs(), vector(rotation).cwiseAbs();
    return result;
  }

 private:
  std::mt19937_64 random_{11};
  std::uniform_real_distribution<double> distribution_{-1.0, 1.0};
};

Matrix3d exponential(const Vector3d& rotation) {
  const double angle = rotation.norm();
  return angle > 0.0 ? Eigen::AngleAxisd(angle, rotation / angle).toRotationMatrix() : Matrix3d::Identity();
}

PoseSpace space(Samples& samples) {
  return {exponential(samples.vector(2.0)), samples.vector(50.0), samples.vector(50.0)};
}

/// By the definition of the poses.
Vector3d seen_from_implant(const PoseSpace& space, const PoseParameters& pose, const Vector3d& v) {
  const Matrix3d rotation = exponential(pose.tail<3>()) * space.start_rotation;
  return space.centre + rotation.transpose() * (v - space.start_centre - pose.head<3>());
}

// The largest share of each bound that was met is near 1 for the reach: one that is a tenth too small would be caught.
TEST(PoseBox, PointsStayWithinReachAndRemainder) {
  Samples samples;
  double largest_reach = 0.0;
  double largest_remainder = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const PoseSpace poses = space(samples);
    const double scale = std::pow(2.0, samples.uniform(6.0) - 6.0);
    const PoseBox box = samples.box(20.0 * scale * scale, 1.5 * scale);
    const PoseBoxMotion motion(poses, box, kRounding);
    const Vector3d v = samples.vector(100.0);
    const PoseBoxMotion::Place place = motion.place(v);
    EXPECT_LE((place.point - seen_from_implant(poses, box.centre, v)).norm(), kRounding);
    const Vector3d normal = samples.vector(1.0).normalized();
    const PoseParameters slope = motion.slope(place, normal);
    for (int k = 0; k < 20; ++k) {
      const PoseParameters pose = samples.of(box);
      const Vector3d moved = seen_from_implant(poses, pose, v) - place.point;
      ASSERT_LE(moved.norm(), place.reach);
      const double error = std::abs(normal.dot(moved) - slope.dot(pose - box.centre));
      ASSERT_LE(error, place.remainder);
      largest_reach = std::max(largest_reach, moved.norm() / place.reach);
      largest_remainder = std::max(largest_remainder, error / place.remainder);
    }
  }
  EXPECT_GT(largest_reach, 0.98);
  EXPECT_GT(largest_remainder, 0.5);
}

}  // namespace
}  // namespace verisq::verify
