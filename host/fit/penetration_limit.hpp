/// Climbs to the nearest maximum of the objective among the candidates that no point of the cavity enters too deep.
#pragma once

#include "host/fit/full_evaluation.hpp"

namespace verisq::fit_search {

/// A semi-infinite program solved by constraint generation: an optimum under the constraints of the worst points, then
/// those that it violates added, until there are none. A small margin, within which the optimiser may err, keeps its
/// answer within the limit. Whatever it evaluates is offered to the incumbent. Returns where it ended, which lies
/// beyond the limit where no candidate nearby respects it.
void refine_within_limit(FullEvaluation& cavity, const Parameters& start);

/// Only moves a candidate beyond the limit to a near one within it, if there is one.
void restore_within_limit(FullEvaluation& cavity, const Parameters& start);

}  // namespace verisq::fit_search
