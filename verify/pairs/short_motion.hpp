/// A solid that turns and shifts steadily, about a moment: how far its points come in a short time.
#pragma once

#include "verify/analysis/cross_product.hpp"
#include "verify/proof/rigid_motion.hpp"

namespace verisq::verify {

/// x'(s) = spin x (x - t(s)) + velocity for every point x of the moving solid, t being where its origin is.
struct SteadyMotion {
  PreciseVector velocity;
  PreciseVector spin;  ///< constant, as the velocity is
};

/// It contains a solid, or a part of one.
struct EnclosingSphere {
  PreciseVector centre;
  PreciseInterval radius;
};

/// At all times at most `reach` before or after the moment, as long as the motion lasts (docs/mathematics.md §26). All
/// vectors in the frame in which it moves.
class ShortMotion {
 public:
  /// At `pose` at the moment. Precondition: reach >= 0.
  ShortMotion(const RigidMotion& pose, const SteadyMotion& motion, double reach);

  /// At rest.
  explicit ShortMotion(const RigidMotion& pose) : ShortMotion(pose, {}, 0.0) {}

  [[nodiscard]] const RigidMotion& pose() const { return pose_; }

  /// Of the point that is there at the moment, at the speed of the moment, until the last of the times.
  [[nodiscard]] PreciseVector first_way_of(const PreciseVector& at) const {
    return (cross(motion_.spin, PreciseVector(at - pose_.translation)) + motion_.velocity) * time_;
  }

  /// No smaller than the way between where a point of the solid is at the moment, which is given, and at any of the
  /// times.
  [[nodiscard]] PreciseInterval way_of(const PreciseVector& at) const {
    return way_of(EnclosingSphere{at, PreciseInterval(0)});
  }

  /// The same of every point of the solid in the sphere.
  [[nodiscard]] PreciseInterval way_of(const EnclosingSphere& sphere) const;

  /// The same of what rests in the sphere, as the moving solid sees it.
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
  /// At the speed of the moment, which differs by the rate of the turn times the way from the sphere's centre.
  [[nodiscard]] PreciseInterval way_at_first_speed(const EnclosingSphere& sphere) const;
  /// No smaller than how far any point in the sphere comes off the straight way that it sets out on.
  [[nodiscard]] PreciseInterval bend_of_ways(const EnclosingSphere& sphere) const;

  RigidMotion pose_;
  SteadyMotion motion_;
  PreciseInterval time_;  ///< the reach
  PreciseInterval rate_;  ///< of the turn
  bool rests_;
};

}  // namespace verisq::verify
