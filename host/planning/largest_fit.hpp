/// The largest implant of a series, or the largest sizes, of which everything asked is proven.
#pragma once

#include <verisq/fit_problem.hpp>
#include <verisq/fit_solution.hpp>

namespace verisq::planning {

/// As solve_fit says. That no larger one can keep the conditions is not proven: the search found no pose of one.
[[nodiscard]] FitSolution largest_fit(const FitProblem& problem, const FitSolutionOptions& options);

}  // namespace verisq::planning
