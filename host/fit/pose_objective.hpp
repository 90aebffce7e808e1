/// Evaluates many candidates for the pose of an implant against all points of a cavity in one launch of a device.
#pragma once

#include <memory>
#include <span>

#include "host/device/device.hpp"
#include "host/fit/candidate_evaluation.hpp"

namespace verisq::device {

/// An evaluator that keeps `points`, with one of `weights` each, on the device; a call brings the candidates there and
/// their evaluations back, in launches of at most about a fifth of a second on two processor cores (at least one
/// candidate each). The same call gives the same bits again, and so does a candidate among others. Distances outside
/// and of shallow points inside are right to about 1e-12 of the primitive's size, but for those whose search misses the
/// closest point: one outside in some 200,000, of tapered primitives one in 2,000, with exponents above 1.4 a few in a
/// thousand. Deep inside, where several faces are about equally near, depths may be overestimated (one in a hundred).
/// Exponents above 1.95 count as 1.95: a solid at most 3.5 % larger. The first call compiles its kernels, or takes them
/// from the cache. Throws Error(failure) here and in calls where the device fails. Precondition: at least one point;
/// finite; weights >= 0; stride > 0; at least one primitive a candidate, none bent; candidates of a call agree on which
/// primitives are tapered.
[[nodiscard]] std::unique_ptr<fit_search::CandidateEvaluator> device_candidate_evaluator(
    const Device& device, std::span<const Point> points, std::span<const double> weights);

}  // namespace verisq::device
