/// The parts of a check: judgements, and intersections of proven enclosures.
#pragma once

#include <algorithm>
#include <concepts>
#include <string>

#include "verisq/checker.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// Compares a claimed enclosure with a proven one.

/// `proven` encloses the exact value, or the values of all members of an uncertain model. `some_member` encloses the
/// value of one member.
[[nodiscard]] inline Finding judged(const Enclosure& claimed, const Enclosure& proven, const Enclosure& some_member) {
  if (claimed.lo > claimed.hi || claimed.lo > some_member.hi || claimed.hi < some_member.lo) {
    return {Verdict::refuted, proven};
  }
  if (proven.lo >= claimed.lo && proven.hi <= claimed.hi) return {Verdict::proved, proven};
  return {Verdict::unproved, proven};
}

// Combines two proofs of one number.

/// Throws Error(failure) with a message that `what` was proven, and both enclosures.
[[noreturn]] void report_contradiction(const Enclosure& a, const Enclosure& b, const std::string& what);

/// "(x, y, z)", for messages.
[[nodiscard]] std::string text_of(const Point& x);

/// Both enclosures contain the exact value. If they have nothing in common, or contain NaN, one of the proofs is wrong,
/// which must never pass silently: throws Error(failure). `describe()` names the value; it is called only then.
template <std::invocable Describe>
[[nodiscard]] Enclosure intersection(const Enclosure& a, const Enclosure& b, const Describe& describe) {
  const Enclosure both{std::max(a.lo, b.lo), std::min(a.hi, b.hi)};
  if (!(both.lo <= both.hi)) report_contradiction(a, b, describe());
  return both;
}

/// The enclosure of two ends that are proven apart from each other; throws the same error.
template <std::invocable Describe>
[[nodiscard]] Enclosure between(double lower, double upper, const Describe& describe) {
  return intersection({lower, infinity}, {-infinity, upper}, describe);
}

}  // namespace verisq::verify
