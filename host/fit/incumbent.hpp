/// The best candidate of an implant so far, kept for when the caller interrupts.
#pragma once

#include <optional>

#include "host/fit/candidate_space.hpp"

namespace verisq::fit_search {

/// A candidate evaluated at every point of the cavity.
struct Found {
  Parameters parameters;
  double objective;
  double deepest_penetration;  ///< >= 0
  bool within_limit;
  double broken;       ///< of what is asked besides, as Requirements counts
  double apart = 0.0;  ///< what is missing of contact
};

/// What breaks less of what is asked; within the limit before beyond it; beyond it, the shallower; then what misses
/// less of contact, which is worth no bone; then the larger objective.
[[nodiscard]] inline bool better(const Found& a, const Found& b) {
  if (a.broken != b.broken) return a.broken < b.broken;
  if (a.within_limit != b.within_limit) return a.within_limit;
  if (!a.within_limit && a.deepest_penetration != b.deepest_penetration)
    return a.deepest_penetration < b.deepest_penetration;
  if (a.apart != b.apart) return a.apart < b.apart;
  return a.objective > b.objective;
}

class Incumbent {
 public:
  /// Of equals the earlier stays.
  void offer(const Found& found) {
    if (!best_ || better(found, *best_)) best_ = found;
  }
  [[nodiscard]] const std::optional<Found>& best() const { return best_; }

 private:
  std::optional<Found> best_;
};

}  // namespace verisq::fit_search
