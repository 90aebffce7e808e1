/// What a proven enclosure says of a claimed one.
#pragma once

#include "verisq/checker.hpp"

namespace verisq::verify {

/// `proven` encloses the exact value, or those of all members of an uncertain model; `some_member` encloses that of
/// one.
[[nodiscard]] inline Finding judged(const Enclosure& claimed, const Enclosure& proven, const Enclosure& some_member) {
  if (claimed.lo > claimed.hi || claimed.lo > some_member.hi || claimed.hi < some_member.lo) {
    return {Verdict::refuted, proven};
  }
  if (proven.lo >= claimed.lo && proven.hi <= claimed.hi) return {Verdict::proved, proven};
  return {Verdict::unproved, proven};
}

}  // namespace verisq::verify
