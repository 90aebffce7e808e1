/// The conditions of a fit, from its proof.
#pragma once

#include <string_view>
#include <vector>
#include <verisq/fit_conditions.hpp>
#include <verisq/fit_problem.hpp>
#include <verisq/fit_solution.hpp>

namespace verisq::planning {

/// Its name.
inline constexpr std::string_view limit_condition = "smallest distance";

/// The changes that a range is asked of.
[[nodiscard]] std::vector<FitCondition> conditions_of_changes(const FitProblem& problem, const FemurFeatures& changes);

/// All: the limit of penetration, sides, changes, contact.
[[nodiscard]] std::vector<FitCondition> conditions_of(const FitProblem& problem, const Fit& fit, const FitProof& proof);

}  // namespace verisq::planning
