/// The parts of a check: judgements, intersections of proven enclosures, steps.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <functional>
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

// Works through the parts of a certificate, so that it can be watched and interrupted.

class CheckSteps {
 public:
  /// `all` is the number of all parts. The options must outlive this.
  CheckSteps(std::size_t all, const CheckOptions& options) : all_(all), options_(&options) {}

  /// Calls work(i) for each i below `count`, or for fewer once interrupted.
  template <class Work>
  void each(std::size_t count, const Work& work) {
    constexpr std::size_t at_a_time = 64;  // between which progress is told
    for (std::size_t first = 0; first < count && !options_->interrupted(); first += at_a_time) {
      const std::size_t now = std::min(at_a_time, count - first);
      options_->in_parallel(now, [&](std::size_t i) {
        if (!options_->interrupted()) work(first + i);
      });
      done_ += now;
      options_->progress(static_cast<double>(done_) / static_cast<double>(all_));
    }
  }

  /// A hook for long work within a part.
  [[nodiscard]] const std::function<bool()>& interrupted() const { return options_->interrupted; }

 private:
  std::size_t all_;
  std::size_t done_ = 0;
  const CheckOptions* options_;
};

}  // namespace verisq::verify
