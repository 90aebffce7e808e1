/// Evaluates candidates on the host alone, for `--device host` and where no device serves.
#pragma once

#include <memory>

#include "host/fit/candidate_evaluation.hpp"

namespace verisq::fit_search {

/// An evaluator on all processors; the same call gives the same bits again, on any number of them. Precondition: at
/// least one point, as many weights; finite; weights >= 0.
[[nodiscard]] std::unique_ptr<CandidateEvaluator> host_candidate_evaluator(std::span<const Point> points,
                                                                           std::span<const double> weights);

}  // namespace verisq::fit_search
