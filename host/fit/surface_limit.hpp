/// Keeps the implant from cutting the surface between the points of the cavity.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "host/fit/candidate_space.hpp"
#include "host/fit/incumbent.hpp"
#include "host/fit/requirements.hpp"
#include "host/fit/search_watch.hpp"
#include "verisq/cavity.hpp"
#include "verisq/fit.hpp"

namespace verisq::fit_search {

/// Constraint generation once more: a search nearby keeps off a grid of points, `spacing` apart, on the surface about
/// the implant; where a triangle is proven to be cut deeper than the limit all the same, the deepest point known of it
/// is added, until no triangle is. `device` is for the proofs. Returns the last candidate looked at, whose
/// `within_limit` and `deepest_penetration` are of the whole surface and proven. Precondition: the cavity has
/// triangles.
[[nodiscard]] Found within_surface(const CandidateSpace& space, const Found& start, const Cavity& cavity,
                                   const Requirements& asked, double spacing, const FitOptions& options,
                                   const std::string& device, const MakeEvaluator& make_evaluator, SearchWatch& watch);

}  // namespace verisq::fit_search
