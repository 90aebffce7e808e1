/// A path of poses in time, and what is asked of two models at its moments.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "verify/placement/rigid_path.hpp"
#include "verify/sweep/moving_pairs.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// Of one leg; both ends are exact binary64 numbers, as is the middle of what may still be halved.
struct Stretch {
  std::size_t leg;
  double begin, end;         ///< times of the path
  double lower = -infinity;  ///< of the distance, at all its times

  [[nodiscard]] double middle() const { return 0.5 * (begin + end); }
  [[nodiscard]] double reach() const { return 0.5 * (end - begin); }
};

/// What was found at the middle of a stretch.
struct Moment {
  double time;
  double lower;  ///< over the stretch
  double upper;  ///< at the middle; 0 where a common point is proven
};

/// Time k is that of pose k; between two poses the motion is steady. Precondition: as that of RigidPath.
class PosedPath {
 public:
  explicit PosedPath(std::span<const Pose> poses) : poses_(poses.begin(), poses.end()), path_(poses) {}

  [[nodiscard]] double last_time() const { return path_.last_time(); }
  [[nodiscard]] std::span<const Pose> poses() const { return poses_; }

  [[nodiscard]] RigidMotion enclosed_pose(double time) const { return path_.enclosed_pose(time); }

  [[nodiscard]] Pose rounded_pose(double time) const { return path_.rounded_pose(time); }

  [[nodiscard]] SteadyMotion motion_of(std::size_t leg) const;

 private:
  std::vector<Pose> poses_;
  RigidPath path_;
};

/// Two models, one of which moves.
class PathMoments {
 public:
  PathMoments() = default;
  PathMoments(const PathMoments&) = delete;
  PathMoments& operator=(const PathMoments&) = delete;
  virtual ~PathMoments() = default;

  /// Where the distance is proven to be more than `enough`, at all times of the stretch, nothing closer is asked.
  [[nodiscard]] virtual Moment examine(const Stretch& stretch, double enough) const = 0;
};

}  // namespace verisq::verify
