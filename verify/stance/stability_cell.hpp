/// Whether small disturbances of an equilibrium die out, for every parameter of a box (docs/stance.md §8).
#pragma once

#include <vector>
#include <verisq/stance_stability.hpp>

#include "verify/stance/mean_value_range.hpp"
#include "verify/stance/standing_problem.hpp"

namespace verisq::stance {

struct StabilityOfCell {
  StabilityVerdict verdict = StabilityVerdict::open;
  Enclosure growth{-infinity, infinity};           ///< the greatest real part of an eigenvalue, 1/s
  std::vector<EigenvalueEnclosure> eigenvalues{};  ///< all of them, rightmost first; none where it is open
  /// Where it is open: how much each uncertain parameter adds to that, as far as is known.
  std::vector<double> shares{};
};

/// `parameters` has an interval for each parameter of the model.
[[nodiscard]] StabilityOfCell stability_over(const StandingProblem& problem, const Box& parameters);

}  // namespace verisq::stance
