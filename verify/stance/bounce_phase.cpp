/// Steps through compression and return; the two events are taken only where they are proven.
#include "verify/stance/bounce_phase.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "verisq/enclosure.hpp"

namespace verisq::stance {

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
