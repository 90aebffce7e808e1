/// The motion along a path of poses, seen from the moving frame: where a point is, and how far it travels.
#pragma once

#include <span>
#include <vector>

#include "verify/numbers/vector.hpp"
#include "verify/proof/rigid_motion.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// A ball that contains the exact point; both infinite or NaN where numbers overflow.
struct PointBall {
  Point centre;
  double radius;
};

/// Between two poses the translation is linear in time and the rotation turns about a fixed axis at constant speed, by
/// the smaller angle. Time k is pose k; times between are exact binary64 numbers.
class RigidPath {
 public:
  /// A pose to nearest: what is lost is in the radius of `local_point`.
  struct NearestPose {
    std::array<Point, 3> rotation;  ///< rows of R
    Point translation;
    double reach = 0.0;  ///< sum of the magnitudes of what was added up to the translation, where it was; infinite
                         ///< where the rotation is not known to nearest
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
  /// From one pose to the next, in one unit of time; to nearest, what is lost is in the errors.
  struct Leg {
    Point start;        ///< t at its begin, exact
    Point velocity;     ///< t'
    Point spin;         ///< rotation vector
    double spin_error;  ///< no smaller than the distance to the exact spin
    double reach;       ///< |t|_1 at the begin, plus that at the end
  };

  /// Of all legs before one: how far `about` travels, and by how much all turn, each from below and from above.
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

}  // namespace verisq::verify
