/// What an implant changes of a bone's features, as ranges that a fit keeps to.
#pragma once

#include <cstddef>
#include <vector>
#include <verisq/features.hpp>
#include <verisq/fit.hpp>

#include "host/command_line/fit_problem.hpp"

namespace verisq::command_line {

/// By the implant of the series in this pose. Precondition: the problem has the bone's landmarks.
[[nodiscard]] FemurFeatures changes_of(const FitProblem& problem, double landmark_radius, std::size_t implant,
                                       const Pose& pose);

/// Throws Error(input) for features that bone and implants say nothing of.
void check_kept(const FitArguments& arguments, const FitProblem& problem);

/// The problem must outlive them.
[[nodiscard]] std::vector<FitConstraint> constraints_of(const FitArguments& arguments, const FitProblem& problem);

}  // namespace verisq::command_line
