/// A path of poses in intervals: its legs' motions and its poses at times, for the proofs of what moves along it.
#pragma once

#include <map>
#include <mutex>
#include <span>
#include <vector>

#include "verify/numbers/vector.hpp"
#include "verify/placement/rigid_path.hpp"

namespace verisq::verify {

/// x -> R x + t
struct EnclosedPose {
  Matrix3<double> rotation;
  Vector3<double> translation;
};

/// Of one leg, in one unit of time: t' and the rotation vector.
struct EnclosedMotion {
  Vector3<double> velocity;
  Vector3<double> spin;
  bool turns;  ///< else the spin is exactly 0
};

/// Safe to ask from many threads. A single pose is a leg in which nothing moves.
class EnclosedPath {
 public:
  /// Precondition: as RigidPath.
  explicit EnclosedPath(std::span<const Pose> poses);

  [[nodiscard]] std::size_t legs() const { return motions_.size(); }
  [[nodiscard]] const EnclosedMotion& motion(std::size_t leg) const { return motions_[leg]; }

  /// Times within a leg that turns are whole multiples of this.
  [[nodiscard]] double step() const { return step_; }

  /// At the share `time` in [0, 1] of a leg.
  [[nodiscard]] EnclosedPose pose(std::size_t leg, double time) const;

 private:
  RigidPath path_;
  std::vector<EnclosedMotion> motions_;
  double step_;
  mutable std::mutex mutex_;
  mutable std::map<double, EnclosedPose> poses_;  ///< those asked for, but along legs that do not turn
};

}  // namespace verisq::verify
