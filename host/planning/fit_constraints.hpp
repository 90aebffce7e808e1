/// What an implant changes of a bone's features, as ranges that a fit keeps to.
#pragma once

#include <vector>
#include <verisq/fit.hpp>
#include <verisq/fit_problem.hpp>

namespace verisq::planning {

/// Throws Error(input) for features that bone and implants say nothing of.
void check_kept(const FitProblem& problem);

/// The problem must outlive them.
[[nodiscard]] std::vector<FitConstraint> constraints_of(const FitProblem& problem);

}  // namespace verisq::planning
