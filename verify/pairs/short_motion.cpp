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

PreciseInterval ShortMotion::way_of(const PreciseVector& at) const {
  if (rests_) return PreciseInterval(0);
  const PreciseVector from_origin = at - pose_.translation;
  const PreciseInterval speed = length<Real>(PreciseVector(cross(motion_.spin, from_origin) + motion_.velocity));
  return time_ * speed + bend_of_ways({at, PreciseInterval(0)});
}

}  // namespace verisq::verify
