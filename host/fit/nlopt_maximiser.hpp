/// Maximises a smooth function of bounded parameters under inequality constraints, by NLopt's SLSQP.
#pragma once

#include <functional>
#include <span>

#include "host/fit/candidate_space.hpp"

namespace verisq::fit_search {

struct MaximisationProblem {
  const Parameters& lower;
  const Parameters& upper;
  Parameters units;  ///< steps of this size change the objective noticeably: the optimiser counts in them
  double typical;    ///< size of the objective, > 0

  /// Returns the objective and writes its derivatives.
  std::function<double(std::span<const double> parameters, std::span<double> gradient)> objective;

  /// Constraints are numbers that must not be negative, or by no more than the tolerance: an optimum lies on some of
  /// them, and rounding to either side. `jacobian` holds their derivatives row by row.
  std::size_t constraints = 0;
  double constraint_tolerance = 0.0;
  std::function<void(std::span<const double> parameters, std::span<double> values, std::span<double> jacobian)>
      constrain = {};

  /// Polled before each evaluation; true ends the search with the best so far.
  std::function<bool()> interrupted;
};

struct StoppingCriteria {
  double step;  ///< of every parameter, in its unit
  int evaluations;
};

/// A local maximum near the start, as far as the criteria let it come. What the functions throw is passed on.
/// Precondition: the start lies within the bounds.
[[nodiscard]] Parameters maximised(const MaximisationProblem& problem, const Parameters& start,
                                   const StoppingCriteria& stop);

}  // namespace verisq::fit_search
