/// Taylor's theorem for the points of a solid that turns and shifts steadily (docs/mathematics.md §26).
#include "verify/pairs/short_motion.hpp"

namespace verisq::verify {

ShortMotion::ShortMotion(const RigidMotion& pose, const SteadyMotion& motion, double reach)
    : pose_(pose), motion_(motion), time_(Real(reach)), rate_(length<Real>(motion.spin)), rests_(reach == 0.0) {}

// A point at x, from the origin, has the acceleration w x (w x x), at most |w| |w x x|; the turn keeps |w x x|. Off a
// centre by r at most, it has at most |w| (|w x centre| + |w| r).
PreciseInterval ShortMotion::bend_of_ways(const EnclosingSphere& sphere) const {
  const PreciseVector from_origin = sphere.centre - pose_.translation;
  const PreciseInterval across = length<Real>(PreciseVector(cross(motion_.spin, from_origin)));
  return PreciseInterval(Real(0.5)) * square(time_) * rate_ * (across + rate_ * sphere.radius);
}

PreciseInterval ShortMotion::way_at_first_speed(const EnclosingSphere& sphere) const {
  return length<Real>(first_way_of(sphere.centre)) + time_ * rate_ * sphere.radius;
}

// At all times its points are faster than its centre by |w| r at most, so that the centre's acceleration alone counts.
PreciseInterval ShortMotion::way_of(const EnclosingSphere& sphere) const {
  if (rests_) return PreciseInterval(0);
  return way_at_first_speed(sphere) + bend_of_ways({sphere.centre, PreciseInterval(0)});
}

// The speed of what rests at x is |w x (x - t) + v|, too, which changes by w x v, as t does by v.
PreciseInterval ShortMotion::way_seen_of(const EnclosingSphere& sphere) const {
  if (rests_) return PreciseInterval(0);
  const PreciseInterval change = length<Real>(cross(motion_.spin, motion_.velocity));
  return way_at_first_speed(sphere) + PreciseInterval(Real(0.5)) * square(time_) * change;
}

}  // namespace verisq::verify
