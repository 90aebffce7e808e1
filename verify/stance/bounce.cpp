/// Free flight in closed form, the contact phase by verified integration, and the hull over the restitutions.
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <verisq/stance_bounce.hpp>

#include "verify/stance/bounce_phase.hpp"
#include "verify/stance/contact_damping.hpp"

namespace verisq::stance {

namespace {

using verify::Direction;
using verify::PreciseInterval;
using verify::Real;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

PreciseInterval precise(double value) {
  return PreciseInterval{Real(value)};
}

Interval rounded_outwards(const PreciseInterval& a) {
  return {a.lower().to_double(Direction::down), a.upper().to_double(Direction::up)};
}

Enclosure enclosure(const Interval& a) {
  return {a.lower(), a.upper()};
}

bool positive(double value) {
  return value > 0.0 && std::isfinite(value);
}

bool meaningful(const Drop& drop) {
  return positive(drop.mass) && positive(drop.radius.lo) && positive(drop.radius.hi) &&
         drop.radius.lo <= drop.radius.hi && positive(drop.height) && positive(drop.gravity) &&
         positive(drop.stiffness) && (drop.exponent == 1.0 || drop.exponent == 1.5) && drop.restitution.lo > 0.0 &&
         drop.restitution.lo <= drop.restitution.hi && drop.restitution.hi < 1.0;
}

Bounce nothing_proven() {
  constexpr Enclosure anything{-kInfinity, kInfinity};
  return {anything, anything, anything, anything, anything, anything, 0.0, false};
}

/// BounceFlow's units, and gravity in them. The cylinder lies: its lowest point falls by the height, whatever the
/// radius.
struct Units {
  Interval fall_time;  ///< from rest to touch-down
  Interval speed;      ///< at touch-down
  Interval time;
  Interval length;
  Interval gravity;

  explicit Units(const Drop& drop) {
    const PreciseInterval g = precise(drop.gravity);
    const PreciseInterval twice_height = precise(2.0) * precise(drop.height);
    const PreciseInterval n = precise(drop.exponent);
    const PreciseInterval one(1);
    const PreciseInterval v = sqrt(g * twice_height);
    const PreciseInterval inverse_square = precise(drop.stiffness) * pow(v, n - one) / precise(drop.mass);
    const PreciseInterval t = pow(one / inverse_square, one / (n + one));
    fall_time = rounded_outwards(sqrt(twice_height / g));
    speed = rounded_outwards(v);
    time = rounded_outwards(t);
    length = rounded_outwards(v * t);
    gravity = rounded_outwards(g * t / v);
  }
};

/// The contact phase for each damping factor of an interval.
///
/// Rebound and greatest penetration fall as D rises, so that the ends of the interval bound them: over the penetration
/// x, the velocity has dw/dx = gamma/w - x^n (1/w + D) on the way down, whose right side falls with D, so that a
/// greater D stops earlier; on the way back the speed z has -dz/dx = (x^n - gamma)/z - x^n D, which starts from 0
/// earlier (but where x^n >= gamma still, so that a lesser D has not turned again by then) and again falls with D. A
/// body that does not lift off on its first way back never does: it turns where x^n < gamma, with the negative energy
/// x (x^n/(n+1) - gamma). It counts as rebound 0.
///
/// No such order is proven for the time of lift-off: that is the hull over a subdivision.
class ContactPhases {
 public:
  ContactPhases(const BounceFlow& flow, const Interval& damping, double tolerance,
                const std::function<bool()>& interrupted)
      : flow_(flow), tolerance_(tolerance), interrupted_(interrupted) {
    const ContactPhase least_damped = integrate(damping.lower());
    const ContactPhase most_damped = integrate(damping.upper());
    deepest = hull(least_damped.deepest, most_damped.deepest);
    rebound = hull(least_damped.rebound, most_damped.rebound);
    lift_off = hull(least_damped.lift_off, most_damped.lift_off);
    proven = least_damped.outcome != Outcome::open && most_damped.outcome != Outcome::open;
    if (proven) extend_lift_off(damping, 0);
  }

  Interval deepest, rebound, lift_off;
  std::size_t steps = 0;
  bool proven;

 private:
  ContactPhase integrate(const Interval& damping) {
    const ContactPhase phase = contact_phase(flow_, damping, tolerance_, interrupted_);
    steps += phase.steps;
    return phase;
  }

  void extend_lift_off(const Interval& damping, int depth) {
    constexpr double narrow = 0.1;  // of the damping factor
    constexpr int deepest_bisection = 12;
    const double middle = damping.lower() + 0.5 * (damping.upper() - damping.lower());
    const bool divisible = depth < deepest_bisection && damping.lower() < middle && middle < damping.upper();
    if (!divisible || damping.upper() - damping.lower() <= narrow * damping.upper()) {
      const ContactPhase phase = integrate(damping);
      const bool may_stay = lift_off.upper() == kInfinity;
      if (phase.outcome == Outcome::lifts_off || may_stay || !divisible || (interrupted_ && interrupted_())) {
        lift_off = hull(lift_off, phase.lift_off);
        // It lifts off for both ends, and so for all between them: an open time is not proven to be infinite.
        if (phase.outcome != Outcome::lifts_off && !may_stay) proven = false;
        return;
      }
    }
    extend_lift_off({damping.lower(), middle}, depth + 1);
    extend_lift_off({middle, damping.upper()}, depth + 1);
  }

  const BounceFlow& flow_;
  double tolerance_;
  const std::function<bool()>& interrupted_;
};

Bounce proven_bounce(const Drop& drop, const BounceOptions& options) {
  const Units units(drop);
  const Interval damping = damping_factor(Interval(drop.restitution.lo, drop.restitution.hi));
  const BounceFlow flow(units.gravity, drop.exponent);
  // The rebound speed is about the restitution: so the tolerance is relative to it.
  const double tolerance = options.relative_tolerance * drop.restitution.lo;
  const ContactPhases phases(flow, damping, tolerance, options.interrupted);
  return {.touch_down_time = enclosure(units.fall_time),
          .touch_down_speed = enclosure(units.speed),
          .lift_off_time = enclosure(units.fall_time + units.time * phases.lift_off),
          .rebound_speed = enclosure(units.speed * phases.rebound),
          .deepest_penetration = enclosure(units.length * phases.deepest),
          .effective_restitution = enclosure(phases.rebound),
          .steps = static_cast<double>(phases.steps),
          .proven = phases.proven};
}

}  // namespace

Bounce bounce(const Drop& drop, const BounceOptions& options) {
  if (!meaningful(drop)) return nothing_proven();
  try {
    return proven_bounce(drop, options);
  } catch (const std::domain_error&) {  // units or a damping factor beyond binary64
    return nothing_proven();
  }
}

}  // namespace verisq::stance
