/// Models that move: short motions and paths of poses.
#pragma once

#include <cstddef>
#include <map>
#include <mutex>
#include <span>
#include <vector>

#include "verify/numbers/functions.hpp"
#include "verify/numbers/vector.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// A solid that turns and shifts steadily, about a moment: how far its points come in a short time.

/// x'(s) = spin x (x - t(s)) + velocity for every point x of the moving solid, t being where its origin is.
struct SteadyMotion {
  PreciseVector velocity;
  PreciseVector spin;  ///< constant, as the velocity is
};

/// A sphere that contains a solid, or a part of one.
struct EnclosingSphere {
  PreciseVector centre;
  PreciseInterval radius;
};

/// A motion at all times at most `reach` before or after the moment, as long as the motion lasts (docs/mathematics.md
/// §26). All vectors are in the frame in which the solid moves.
class ShortMotion {
 public:
  /// The solid is at `pose` at the moment. Precondition: reach >= 0.
  ShortMotion(const RigidMotion& pose, const SteadyMotion& motion, double reach);

  /// A solid at rest.
  explicit ShortMotion(const RigidMotion& pose) : ShortMotion(pose, {}, 0.0) {}

  [[nodiscard]] const RigidMotion& pose() const { return pose_; }

  /// The way of the point that is at `at` at the moment, at the speed of the moment, until the last of the times.
  [[nodiscard]] PreciseVector first_way_of(const PreciseVector& at) const {
    return (cross(motion_.spin, PreciseVector(at - pose_.translation)) + motion_.velocity) * time_;
  }

  /// For a point of the solid that is at `at` at the moment: no smaller than its way from there to its place at any of
  /// the times.
  [[nodiscard]] PreciseInterval way_of(const PreciseVector& at) const {
    return way_of(EnclosingSphere{at, PreciseInterval(0)});
  }

  /// The same for every point of the solid in the sphere.
  [[nodiscard]] PreciseInterval way_of(const EnclosingSphere& sphere) const;

  /// The same for every resting point in the sphere, as the moving solid sees it.
  [[nodiscard]] PreciseInterval way_seen_of(const EnclosingSphere& sphere) const;

  /// The lower end is no more than n·x of any point x of a part of the solid, at any of the times. At the moment the
  /// part lies in the sphere, and `reach_towards(m)` is no smaller than m·(x - from) of any of its points.
  template <class Reach>
  [[nodiscard]] PreciseInterval least_along(const PreciseVector& n, const EnclosingSphere& sphere,
                                            const PreciseVector& from, const Reach& reach_towards) const {
    if (rests_) return n.dot(from) - PreciseInterval(reach_towards(PreciseVector(-n)));
    const PreciseVector from_origin = from - pose_.translation;
    const PreciseVector turned = cross(n, motion_.spin);  // n·(w x x) = (n x w)·x
    const auto after = [&](const PreciseInterval& time) {
      const PreciseVector m = n + turned * time;
      return n.dot(pose_.translation) + time * n.dot(motion_.velocity) + m.dot(from_origin) -
             PreciseInterval(reach_towards(PreciseVector(-m)));
    };
    // Minus a support function along a line is concave in time: least at an end, of which lower bounds are at hand.
    const PreciseInterval at_first = after(-time_);
    const PreciseInterval at_last = after(time_);
    const PreciseInterval& least = at_first.lower() < at_last.lower() ? at_first : at_last;
    return PreciseInterval(least.lower()) - bend_of_ways(sphere) * length<Real>(n);
  }

 private:
  /// The way at the speed of the moment. A point's speed differs from the centre's by the rate of the turn times the
  /// way from the sphere's centre.
  [[nodiscard]] PreciseInterval way_at_first_speed(const EnclosingSphere& sphere) const;
  /// No smaller than the deviation of any point in the sphere from the straight way on which it sets out.
  [[nodiscard]] PreciseInterval bend_of_ways(const EnclosingSphere& sphere) const;

  RigidMotion pose_;
  SteadyMotion motion_;
  PreciseInterval time_;  ///< the reach
  PreciseInterval rate_;  ///< the rate of the turn
  bool rests_;
};

// The motion along a path of poses, seen from the moving frame: where a point is, and how far it travels.

/// A ball that contains the exact point; both infinite or NaN where numbers overflow.
struct PointBall {
  Point centre;
  double radius;
};

/// Between two poses the translation is linear in time and the rotation turns about a fixed axis at constant speed, by
/// the smaller angle. Time k is pose k; times between are exact binary64 numbers.
class RigidPath {
 public:
  /// A pose rounded to nearest; the radius of `local_point` covers the rounding.
  struct NearestPose {
    std::array<Point, 3> rotation;  ///< rows of R
    Point translation;
    double reach = 0.0;  ///< sum of the magnitudes of the terms of the translation, where it is a sum; infinite if the
                         ///< rotation is not known to nearest
  };

  /// Lengths of many legs are as tight as the points are near to `about`. Precondition: at least one pose; each finite,
  /// with a quaternion that is not zero.
  explicit RigidPath(std::span<const Pose> poses, const Point& about = {});

  [[nodiscard]] double last_time() const { return static_cast<double>(poses_.size() - 1); }

  /// The rotation vector of the leg from pose k to the next one, enclosed.
  [[nodiscard]] Vector3<double> spin(std::size_t k) const;

  /// Precondition: 0 <= time <= last_time().
  [[nodiscard]] NearestPose nearest_pose(double time) const;

  /// Hardly off the exact pose; at the times of poses they themselves. Precondition: 0 <= time <= last_time().
  [[nodiscard]] Pose rounded_pose(double time) const;

  /// The exact pose, enclosed. Precondition: 0 <= time <= last_time().
  [[nodiscard]] RigidMotion enclosed_pose(double time) const;

  /// R^T (c - t)
  [[nodiscard]] static PointBall local_point(const NearestPose& pose, const Point& c);

  /// No smaller than the length of the way of R^T (c - t) between two times, in a time that does not depend on the
  /// number of legs; infinite on overflow. Precondition: 0 <= begin <= end <= last_time().
  [[nodiscard]] double length_up(const Point& c, double begin, double end) const;

 private:
  /// The motion from one pose to the next, in one unit of time, rounded to nearest; the errors bound the rounding.
  struct Leg {
    Point start;        ///< t at its begin, exact
    Point velocity;     ///< t'
    Point spin;         ///< rotation vector
    double spin_error;  ///< no smaller than the distance to the exact spin
    double reach;       ///< |t|_1 at the begin, plus that at the end
  };

  /// The travel along all legs before one: how far `about` travels, and by how much all turn, each from below and from
  /// above.
  struct Travelled {
    Enclosure way, angle;
  };

  [[nodiscard]] static Leg leg(const Pose& from, const Pose& to);
  [[nodiscard]] Travelled travelled_further(const Travelled& before, const Leg& leg) const;
  [[nodiscard]] double length_of_legs_up(const Point& c, double begin, double end) const;
  [[nodiscard]] double length_leg_by_leg_up(const Point& c, double begin, double end) const;
  [[nodiscard]] static double speed_up(const Leg& leg, const Point& c, double time);

  std::vector<Pose> poses_;  ///< consecutive quaternions at most a right angle apart, as vectors of four
  Point about_;
  std::vector<Leg> legs_;
  std::vector<Travelled> travelled_;  ///< before each leg, and after the last
};

// A path of poses in intervals: the motions of its legs and its poses at times, for proofs about a body that moves
// along it.

/// x -> R x + t
struct EnclosedPose {
  Matrix3<double> rotation;
  Vector3<double> translation;
};

/// The motion of one leg, in one unit of time: t' and the rotation vector.
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

  /// The pose at the share `time` in [0, 1] of a leg.
  [[nodiscard]] EnclosedPose pose(std::size_t leg, double time) const;

 private:
  RigidPath path_;
  std::vector<EnclosedMotion> motions_;
  double step_;
  mutable std::mutex mutex_;
  mutable std::map<double, EnclosedPose> poses_;  ///< the poses computed so far, but not those along legs that do not
                                                  ///< turn
};

// A path of poses in time.

/// Time k is that of pose k; between two poses the motion is steady. Precondition: as that of RigidPath.
class PosedPath {
 public:
  explicit PosedPath(std::span<const Pose> poses) : poses_(poses.begin(), poses.end()), path_(poses) {}

  [[nodiscard]] double last_time() const { return path_.last_time(); }
  [[nodiscard]] std::span<const Pose> poses() const { return poses_; }

  [[nodiscard]] RigidMotion enclosed_pose(double time) const { return path_.enclosed_pose(time); }

  [[nodiscard]] Pose rounded_pose(double time) const { return path_.rounded_pose(time); }

  /// The motion from one time to another about the middle of both, (begin + until) / 2 to nearest. Precondition: 0 <=
  /// begin <= until <= last_time(); no pose lies between them.
  [[nodiscard]] ShortMotion motion_between(double begin, double until) const;

  /// Precondition: the index of a pose with one after it; or 0, for a path of a single pose.
  [[nodiscard]] SteadyMotion motion_of(std::size_t leg) const;

 private:
  std::vector<Pose> poses_;
  RigidPath path_;
};

}  // namespace verisq::verify
