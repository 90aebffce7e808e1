/// What a map asks of a model before it begins: whether it has a point, and rough distances for when the time is up.
#pragma once

#include <functional>

#include "verify/sets/coarse_distance.hpp"
#include "verisq/model.hpp"
#include "verisq/signed_distance.hpp"

namespace verisq {

/// Throws Error(input) where a rough search proves that the model has no point at all.
void refuse_empty(const Model& model, const SignedDistance& distance, const std::function<bool()>& interrupted);

/// Knows rough distances of the primitives' centres, of many spread over their order.
[[nodiscard]] verify::CoarseDistance coarse_distance(const Model& model, const SignedDistance& distance,
                                                     const std::function<bool()>& interrupted);

}  // namespace verisq
