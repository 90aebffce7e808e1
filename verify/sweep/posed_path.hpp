/// A path of poses in time.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "verify/pairs/short_motion.hpp"
#include "verify/placement/rigid_path.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// Time k is that of pose k; between two poses the motion is steady. Precondition: as that of RigidPath.
class PosedPath {
 public:
  explicit PosedPath(std::span<const Pose> poses) : poses_(poses.begin(), poses.end()), path_(poses) {}

  [[nodiscard]] double last_time() const { return path_.last_time(); }
  [[nodiscard]] std::span<const Pose> poses() const { return poses_; }

  [[nodiscard]] RigidMotion enclosed_pose(double time) const { return path_.enclosed_pose(time); }

  [[nodiscard]] Pose rounded_pose(double time) const { return path_.rounded_pose(time); }

  /// From one time to another, of times within two poses, about the middle of both, (begin + until) / 2 to nearest.
  /// Precondition: 0 <= begin <= until <= last_time(); no pose between them.
  [[nodiscard]] ShortMotion motion_between(double begin, double until) const;

  /// Precondition: the index of a pose with one after it; or 0, of a single pose.
  [[nodiscard]] SteadyMotion motion_of(std::size_t leg) const;

 private:
  std::vector<Pose> poses_;
  RigidPath path_;
};

}  // namespace verisq::verify
