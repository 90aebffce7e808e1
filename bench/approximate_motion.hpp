/// Poses and points in plain floating point, for the peers.
#pragma once

#include <Eigen/Geometry>
#include <verisq/model.hpp>

namespace verisq::bench {

[[nodiscard]] inline Eigen::Vector3d vector(const Point& point) {
  return {point[0], point[1], point[2]};
}

[[nodiscard]] inline Point point(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

/// x -> rotation x + translation
struct ApproximateMotion {
  explicit ApproximateMotion(const Pose& pose)
      : rotation(Eigen::Quaterniond(pose.quaternion[0], pose.quaternion[1], pose.quaternion[2], pose.quaternion[3])
                     .normalized()
                     .toRotationMatrix()),
        translation(vector(pose.translation)) {}

  [[nodiscard]] Eigen::Vector3d operator()(const Eigen::Vector3d& x) const { return rotation * x + translation; }

  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
};

}  // namespace verisq::bench
