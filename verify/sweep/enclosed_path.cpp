/// Nearest poses widened by what their rounding loses (rigid_path.cpp), each kept, as its roots cost much.
#include "verify/sweep/enclosed_path.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace verisq::verify {
namespace {

/// Of all legs together: enough to follow a turn, few enough to keep.
constexpr double most_poses = 0x1p14;
constexpr double finest_step = 0x1p-10;
constexpr double coarsest_step = 0x1p-2;

double step_for(std::size_t legs) {
  const double least = static_cast<double>(legs) / most_poses;
  double step = finest_step;
  while (step < std::min(least, coarsest_step)) step *= 2.0;
  return step;
}

Interval about(double x, double radius) {
  return Interval(x) + Interval(-radius, radius);
}

/// An entry of a rotation is at most 1, so that to nearest it is off by 2^-53; a coordinate of the translation by 2^-53
/// of itself and 2^-100 of what was added up to it.
EnclosedPose enclosed(const RigidPath::NearestPose& pose) {
  constexpr double error = 0x1p-52;
  EnclosedPose result;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) result.rotation(i, j) = about(pose.rotation[i][j], error);
    const double t = pose.translation[i];
    result.translation[i] = about(t, error * std::abs(t) + 0x1p-99 * pose.reach + std::numeric_limits<double>::min());
  }
  return result;
}

}  // namespace

EnclosedPath::EnclosedPath(std::span<const Pose> poses) : path_(poses), step_(step_for(poses.size())) {
  for (std::size_t k = 0; k + 1 < poses.size(); ++k) {
    EnclosedMotion& motion = motions_.emplace_back();
    motion.turns = poses[k].quaternion != poses[k + 1].quaternion;
    for (std::size_t i = 0; i < 3; ++i) {
      motion.velocity[i] = Interval(poses[k + 1].translation[i]) - Interval(poses[k].translation[i]);
    }
    if (motion.turns) motion.spin = path_.spin(k);
  }
  if (motions_.empty()) motions_.push_back({{}, {}, false});
}

EnclosedPose EnclosedPath::pose(std::size_t leg, double time) const {
  const auto start = static_cast<double>(leg);
  const bool turns = motions_[leg].turns;
  const double asked = turns ? start + time : start;  // exact: a multiple of the step
  EnclosedPose pose = [&] {
    const std::lock_guard lock(mutex_);
    const auto known = poses_.find(asked);
    if (known != poses_.end()) return known->second;
    return poses_.emplace(asked, enclosed(path_.nearest_pose(asked))).first->second;
  }();
  if (!turns) pose.translation = pose.translation + motions_[leg].velocity * Interval(time);
  return pose;
}

}  // namespace verisq::verify
