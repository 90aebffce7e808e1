/// From touch-down to lift-off or rest on the ground: the contact phase of a bounce, integrated with proofs.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include "verify/stance/bounce_flow.hpp"

namespace verisq::stance {

enum class Outcome {
  lifts_off,
  stays,   ///< on the ground for good
  either,  ///< open which of the two: both modes are in the enclosures
  open,    ///< the integration gave up, or was interrupted
};

/// In BounceFlow's units. Every enclosure holds whatever the outcome is.
struct ContactPhase {
  Outcome outcome;
  Interval deepest;   ///< penetration
  Interval lift_off;  ///< time; the upper end is infinite unless it lifts off
  Interval rebound;   ///< speed; 0 for a body that stays
  std::size_t steps;
};

/// For all gravities gamma and damping factors d of the two; `tolerance` is the local error of a step.
/// Precondition: damping within [0, infinity), gravity positive.
[[nodiscard]] ContactPhase contact_phase(const BounceFlow& flow, const Interval& gravity, const Interval& damping,
                                         double tolerance, const std::function<bool()>& interrupted);

}  // namespace verisq::stance
