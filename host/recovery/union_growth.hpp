/// Unions of one primitive after the other: each time the best of many ways to divide one, or to add one.
#pragma once

#include <functional>

#include "host/recovery/union_fit.hpp"

namespace verisq::recovery {

/// With one primitive more, refined. Deterministic, candidates share the processors. `interrupted` ends it early, with
/// what is best by then.
[[nodiscard]] UnionFit grown(const UnionFit& fit, const std::function<bool()>& interrupted);

/// With as many primitives: one more, and without the one that is missed least then. It may be the worse for that.
/// Precondition: at least two.
[[nodiscard]] UnionFit exchanged(const UnionFit& fit, const std::function<bool()>& interrupted);

/// Sweeps and alternatives of single primitives until nothing is gained.
[[nodiscard]] UnionFit refined(UnionFit fit, int sweeps, const std::function<bool()>& interrupted);

}  // namespace verisq::recovery
