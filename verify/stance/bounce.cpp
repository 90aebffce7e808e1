/// This file implements bounce.hpp.
#include "verify/stance/bounce.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>
#include <verisq/enclosure.hpp>
#include <verisq/stance.hpp>

#include "verify/stance/standing.hpp"

namespace verisq::stance {

namespace {

using verify::Direction;
using verify::PreciseInterval;
using verify::Real;

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

bool positive(const Enclosure& range) {
  return positive(range.lo) && positive(range.hi) && range.lo <= range.hi;
}

bool meaningful(const Drop& drop) {
  return positive(drop.mass) && positive(drop.radius) && positive(drop.height) && positive(drop.gravity) &&
         positive(drop.stiffness) && (drop.exponent == 1.0 || drop.exponent == 1.5) && drop.restitution.lo > 0.0 &&
         drop.restitution.lo <= drop.restitution.hi && drop.restitution.hi < 1.0 && positive(drop.impact_velocity);
}

Bounce nothing_proven() {
  constexpr Enclosure anything{-infinity, infinity};
  return {anything, anything, anything, anything, anything, anything, 0.0, false};
}

/// From rest to touch-down. The cylinder lies: its lowest point falls by the height, whatever radius and mass.
struct Fall {
  PreciseInterval precise_speed;
  Interval speed;
  Interval time;

  explicit Fall(const Drop& drop) {
    const PreciseInterval g = precise(drop.gravity);
    const PreciseInterval twice_height = precise(2.0) * precise(drop.height);
    precise_speed = sqrt(g * twice_height);
    speed = rounded_outwards(precise_speed);
    time = rounded_outwards(sqrt(twice_height / g));
  }
};

/// BounceFlow's units but for the speed at touch-down, and gravity in them, for an interval of masses: the mass occurs
/// once in each, so that they are tight.
struct Units {
  Interval time;
  Interval length;
  Interval gravity;

  Units(const Drop& drop, const PreciseInterval& v, const Interval& mass) {
    const PreciseInterval n = precise(drop.exponent);
    const PreciseInterval one(1);
    const PreciseInterval m{Real(mass.lower()), Real(mass.upper())};
    const PreciseInterval t = pow(m / (precise(drop.stiffness) * pow(v, n - one)), one / (n + one));
    time = rounded_outwards(t);
    length = rounded_outwards(v * t);
    gravity = rounded_outwards(precise(drop.gravity) * t / v);
  }
};

/// d = D v / v_N for all restitutions and impact velocities of the drop.
Interval damping_of(const Drop& drop, const Fall& fall) {
  const Interval at_impact_velocity = damping_factor(Interval(drop.restitution.lo, drop.restitution.hi));
  return at_impact_velocity * (fall.speed / Interval(drop.impact_velocity.lo, drop.impact_velocity.hi));
}

/// An interval of masses and one of damping factors.
struct Cell {
  Interval mass;
  Interval damping;
};

double relative_width(const Interval& a) {
  return (a.upper() - a.lower()) / a.upper();
}

std::optional<std::pair<Interval, Interval>> halves(const Interval& a) {
  const double middle = a.lower() + 0.5 * (a.upper() - a.lower());
  if (!(a.lower() < middle && middle < a.upper())) return std::nullopt;
  return std::pair{Interval(a.lower(), middle), Interval(middle, a.upper())};
}

/// What an integration can take, by experience: one per cent of damping widens its results as much as eight of mass.
constexpr double kNarrowDamping = 0.03;
constexpr double kNarrowMass = 8.0 * kNarrowDamping;

/// Widths by that measure; 1 is narrow.
double width(const Cell& cell) {
  return std::max(relative_width(cell.mass) / kNarrowMass, relative_width(cell.damping) / kNarrowDamping);
}

/// Across the interval that is wider by that measure. Nothing where no number lies between its ends.
std::optional<std::pair<Cell, Cell>> halves(const Cell& cell) {
  if (relative_width(cell.mass) / kNarrowMass > relative_width(cell.damping) / kNarrowDamping) {
    const auto masses = halves(cell.mass);
    if (masses) return std::pair{Cell{masses->first, cell.damping}, Cell{masses->second, cell.damping}};
  }
  const auto dampings = halves(cell.damping);
  if (!dampings) return std::nullopt;
  return std::pair{Cell{cell.mass, dampings->first}, Cell{cell.mass, dampings->second}};
}

/// The contact phase for every mass and damping factor of a box.
///
/// Greatest penetration and rebound are monotone in the mass m and the damping factor d, so that corners of the box
/// bound them. A body that does not lift off on its first way back never does: it turns or comes to rest where
/// x^n <= gamma, with the negative energy x (x^n/(n+1) - gamma). It counts as rebound 0.
///
/// The greatest penetration rises with m and falls as d rises. Over the penetration s in m, the speed V on the way down
/// has V dV/ds = g - (k/m) s^n (1 + D V/v_N), from the same V at s = 0. The right side rises with m and falls as
/// D/v_N = d/v rises, for all s, V > 0; so V does at every s (where two solutions met, the one with the greater right
/// side would come from below), and the depth at which it vanishes.
///
/// The rebound falls as d rises. In BounceFlow's units, a greater d stops earlier, as above; on the way back the speed
/// z has -dz/dx = (x^n - gamma)/z - x^n d, which starts from 0 earlier (but where x^n >= gamma still, so that a lesser
/// d has not turned again by then) and again falls as d rises.
///
/// The rebound falls as m rises, which is as gamma rises: gamma is a positive multiple of m^(1/(n+1)). Of two bodies
/// with gamma_1 < gamma_2, let the second lift off; the first does, then, and at a greater speed. The second is faster
/// at every x of the way down and turns deeper, as above. Let u_i(x) = z^2/2 on the way back: -du_i/dx =
/// x^n (1 - d z) - gamma_i, so that where u_1 = u_2, u_2 - u_1 falls at the rate gamma_2 - gamma_1 on the way from the
/// depth of the first to the surface; it is positive at the beginning, and once it is negative it remains so. If the
/// first turns or comes to rest at some a > 0, or reaches a = 0 with u_1(a) <= u_2(a), then u_2(a) >= u_1(a), and so
/// u_2 >= u_1 on the whole way. The contact takes d x^n |w| dx from the energy of a body, on both ways more from the
/// second, which is faster and goes deeper; both have 1/2 at first. So the energy of the second at a is less. At a = 0
/// the energies are u_i(0): a contradiction. At a > 0 that of the first is negative, as said, and that of the second
/// is, too: it does not lift off, a contradiction.
///
/// No such order is proven for the time of lift-off: that is the hull over a subdivision, fine where a cell sticks out
/// of what the corners attain.
class ContactPhases {
 public:
  ContactPhases(const Drop& drop, const Fall& fall, const BounceOptions& options)
      : drop_(drop), fall_(fall), options_(options), flow_(drop.exponent) {
    const Cell box{Interval(drop.mass.lo, drop.mass.hi), damping_of(drop, fall)};
    add_corners(box);
    if (!proven_) {  // what happens between the corners is open, too
      lift_off_ = Interval(0.0, infinity);
    } else if (lift_off_) {  // otherwise all corners stay, and the whole box does
      extend_lift_off(box, 0, lift_off());
    }
  }

  [[nodiscard]] Interval deepest() const { return *deepest_; }  ///< m
  [[nodiscard]] Interval rebound() const { return *rebound_; }  ///< by the speed at touch-down
  /// s after touch-down.
  [[nodiscard]] Interval lift_off() const {
    if (!lift_off_) return {stays_at_, infinity};
    return {lift_off_->lower(), may_stay_ ? infinity : lift_off_->upper()};
  }
  [[nodiscard]] std::size_t steps() const { return steps_; }
  [[nodiscard]] bool proven() const { return proven_; }

 private:
  /// In m and s but for the rebound.
  struct Phase {
    Outcome outcome;
    Interval deepest, rebound, lift_off;
  };

  static void extend(std::optional<Interval>& sum, const Interval& part) { sum = sum ? hull(*sum, part) : part; }

  Phase integrate(const Cell& cell) {
    const Units units(drop_, fall_.precise_speed, cell.mass);
    // Without gravity it rebounds at more than 1/(1 + d), see contact_damping.cpp.
    const double tolerance = options_.relative_tolerance / (1.0 + cell.damping.upper());
    const ContactPhase phase = contact_phase(flow_, units.gravity, cell.damping, tolerance, options_.interrupted);
    steps_ += phase.steps;
    return {phase.outcome, units.length * phase.deepest, phase.rebound, units.time * phase.lift_off};
  }

  void add_corners(const Cell& box) {
    for (const double mass : std::set{box.mass.lower(), box.mass.upper()}) {
      for (const double damping : std::set{box.damping.lower(), box.damping.upper()}) {
        const Phase phase = integrate({Interval(mass), Interval(damping)});
        extend(deepest_, phase.deepest);
        extend(rebound_, phase.rebound);
        if (phase.outcome == Outcome::open) proven_ = false;
        if (phase.outcome != Outcome::lifts_off) may_stay_ = true;
        add_lift_off(phase);
      }
    }
  }

  void add_lift_off(const Phase& phase) {
    if (phase.outcome == Outcome::stays) {
      stays_at_ = std::min(stays_at_, phase.lift_off.lower());
    } else {
      extend(lift_off_, phase.lift_off);
    }
  }

  /// To the times of lift-off at the corners, of which one lifts off.
  [[nodiscard]] bool adds_little(const Phase& phase, const Interval& corners) const {
    constexpr double little = 0.005;
    if (phase.outcome == Outcome::stays) return may_stay_;
    const double width = may_stay_ ? corners.lower() : corners.upper() - corners.lower();
    const double slack = little * width + options_.relative_tolerance * corners.lower();
    return phase.lift_off.lower() >= corners.lower() - slack && phase.lift_off.upper() <= corners.upper() + slack;
  }

  void extend_lift_off(const Cell& cell, int depth, const Interval& corners) {
    constexpr int deepest_bisection = 16;
    const Phase phase = integrate(cell);
    // No narrower, however much it adds: less is in it where only the first lift-off counts.
    const double finest = may_stay_ ? 1.0 : 0.125;
    const bool settled = phase.outcome == Outcome::lifts_off || may_stay_;
    const bool accepted = adds_little(phase, corners) || (settled && width(cell) <= finest);
    if (const auto parts = halves(cell); parts && !accepted && depth < deepest_bisection && !is_interrupted()) {
      extend_lift_off(parts->first, depth + 1, corners);
      extend_lift_off(parts->second, depth + 1, corners);
      return;
    }
    add_lift_off(phase);
    // It lifts off in all corners, and so in the whole box: an open time is not proven to be infinite.
    if (phase.outcome != Outcome::lifts_off && !may_stay_) proven_ = false;
  }

  [[nodiscard]] bool is_interrupted() const { return options_.interrupted && options_.interrupted(); }

  const Drop& drop_;
  const Fall& fall_;
  const BounceOptions& options_;
  BounceFlow flow_;
  std::optional<Interval> deepest_, rebound_;
  std::optional<Interval> lift_off_;  ///< of those that may lift off
  double stays_at_ = infinity;        ///< when the others are proven to be in contact for good
  bool may_stay_ = false;
  bool proven_ = true;
  std::size_t steps_ = 0;
};

Bounce proven_bounce(const Drop& drop, const BounceOptions& options) {
  const Fall fall(drop);
  const ContactPhases phases(drop, fall, options);
  return {.touch_down_time = enclosure(fall.time),
          .touch_down_speed = enclosure(fall.speed),
          .lift_off_time = enclosure(fall.time + phases.lift_off()),
          .rebound_speed = enclosure(fall.speed * phases.rebound()),
          .deepest_penetration = enclosure(phases.deepest()),
          .effective_restitution = enclosure(phases.rebound()),
          .steps = static_cast<double>(phases.steps()),
          .proven = phases.proven()};
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

namespace {

using Step = TaylorStep<BounceFlow>;
using State = StateBox<BounceFlow::size>;
using Set = ReachableSet<BounceFlow::size>;

constexpr double kFirstLength = 0.125;
constexpr double kShortestLength = 1e-10;
constexpr std::size_t kMostSteps = 20000;

class Integration {
 public:
  Integration(const BounceFlow& flow, const Interval& gravity, const Interval& damping, double tolerance)
      : flow_(flow), tolerance_(tolerance), set_(Set::of(touch_down(gravity, damping))) {}

  ContactPhase run(const std::function<bool()>& interrupted) {
    try {
      while (steps_ < kMostSteps && !(interrupted && interrupted())) {
        if (!advance()) return stuck();
        if (lift_off_) return lifted_off();
        if (returning_ && flow_.energy(set_.hull).upper() < 0.0) return result(Outcome::stays, 0);
      }
    } catch (const std::domain_error&) {  // numbers too large to be enclosed: `set_` is still the last proven one
    }
    return result(Outcome::open, {0.0, greatest_rebound()});
  }

 private:
  static State touch_down(const Interval& gravity, const Interval& damping) {
    State state;
    state << Interval(0), Interval(1), Interval(0), damping, gravity;
    return state;
  }

  /// False where no step is proven.
  bool advance() {
    const double shortest = shortest_length();
    while (length_ > shortest) {
      if (const std::optional<Step> longest = Step::attempt(flow_, set_, length_, tolerance_)) {
        // Another length may have an event within the step that this one has at its end.
        if (accept(*longest)) {
          length_ *= 1.25;
          return true;
        }
        for (const double factor : {1.5, 0.7, 0.4}) {
          const std::optional<Step> other = Step::attempt(flow_, set_, factor * length_, tolerance_);
          if (other && accept(*other)) return true;
        }
      }
      length_ *= 0.7;
    }
    return false;
  }

  /// An event is open as long as some states are before it and others behind: a step much shorter than the set takes to
  /// pass one place will not prove it.
  [[nodiscard]] double shortest_length() const {
    constexpr double part = 0.01;
    const int event = returning_ ? BounceFlow::root_of_penetration : BounceFlow::velocity;
    const Interval& states = set_.hull[event];
    const double rate = abs(flow_.taylor_coefficients(set_.hull, 1)[1][event]).upper();
    return std::max(kShortestLength, part * (states.upper() - states.lower()) / rate);
  }

  /// Goes to the end of the step, or to lift-off, unless it is open what happens on the way.
  bool accept(const Step& step) {
    const Set end = step.at(step.length());
    const Crossing ground = crossing(step, end, BounceFlow::root_of_penetration);
    if (ground == Crossing::unclear || (ground == Crossing::falling && !returning_)) return false;
    if (!returning_) {
      const Crossing turn = crossing(step, end, BounceFlow::velocity);
      if (turn == Crossing::unclear) return false;
      if (turn == Crossing::falling) {
        const State deepest = state_at_crossing(flow_, step, BounceFlow::velocity);
        deepest_ = square(deepest[BounceFlow::root_of_penetration]);
        returning_ = true;
      }
    }
    if (ground == Crossing::falling) lift_off_ = state_at_crossing(flow_, step, BounceFlow::root_of_penetration);
    set_ = end;
    ++steps_;
    return true;
  }

  [[nodiscard]] ContactPhase lifted_off() const {
    ContactPhase phase = result(Outcome::lifts_off, max(Interval(-(*lift_off_)[BounceFlow::velocity]), Interval(0)));
    phase.lift_off = (*lift_off_)[BounceFlow::time];
    return phase;
  }

  /// On the way back with an energy about 0, it lifts off slowly or not at all.
  [[nodiscard]] ContactPhase stuck() const {
    const bool grazing = returning_ && flow_.energy(set_.hull).lower() <= 0.0;
    return result(grazing ? Outcome::either : Outcome::open, {0.0, greatest_rebound()});
  }

  [[nodiscard]] ContactPhase result(Outcome outcome, const Interval& rebound) const {
    return {outcome, deepest_, {set_.hull[BounceFlow::time].lower(), infinity}, rebound, steps_};
  }

  /// The energy is w^2/2 at lift-off and never rises; it is 1/2 at touch-down.
  [[nodiscard]] double greatest_rebound() const {
    const Interval energy = max(flow_.energy(set_.hull), Interval(0));
    return std::min(1.0, sqrt(Interval(2) * energy).upper());
  }

  const BounceFlow& flow_;
  double tolerance_;
  Set set_;  ///< the states at the present time, all in contact
  double length_ = kFirstLength;
  std::size_t steps_ = 0;
  bool returning_ = false;
  Interval deepest_{0.0, infinity};
  std::optional<State> lift_off_;
};

}  // namespace

ContactPhase contact_phase(const BounceFlow& flow, const Interval& gravity, const Interval& damping, double tolerance,
                           const std::function<bool()>& interrupted) {
  return Integration(flow, gravity, damping, tolerance).run(interrupted);
}

}  // namespace verisq::stance
