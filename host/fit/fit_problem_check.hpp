/// Refuses what no search of poses can work with.
#pragma once

#include "verisq/cavity.hpp"
#include "verisq/fit.hpp"

namespace verisq::fit_search {

/// Throws Error(input) for an empty cavity, points that are not finite, and numbers out of the ranges that FitOptions
/// states.
void check_fit_problem(const Cavity& cavity, const Fitness& fitness, double penetration_limit, const PoseRange& range);

}  // namespace verisq::fit_search
