/// What two proofs of one number say together.
#pragma once

#include <algorithm>
#include <concepts>
#include <string>

#include "verisq/enclosure.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// Throws Error(failure) that names `what` was proven, and both enclosures.
[[noreturn]] void report_contradiction(const Enclosure& a, const Enclosure& b, const std::string& what);

/// "(x, y, z)", for messages.
[[nodiscard]] std::string text_of(const Point& x);

/// Both contain the exact value; if they have nothing in common, or hold what is no number, one of the proofs is wrong,
/// which must never pass silently: throws Error(failure). `describe()` says what the value is; called only then.
template <std::invocable Describe>
[[nodiscard]] Enclosure intersection(const Enclosure& a, const Enclosure& b, const Describe& describe) {
  const Enclosure both{std::max(a.lo, b.lo), std::min(a.hi, b.hi)};
  if (!(both.lo <= both.hi)) report_contradiction(a, b, describe());
  return both;
}

/// The ends of which are proven apart from each other; likewise.
template <std::invocable Describe>
[[nodiscard]] Enclosure between(double lower, double upper, const Describe& describe) {
  return intersection({lower, infinity}, {-infinity, upper}, describe);
}

}  // namespace verisq::verify
