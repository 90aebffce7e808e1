/// The best candidate of an implant so far, kept for when the caller interrupts.
#pragma once

#include <cstddef>
#include <optional>

#include "host/fit/candidate_space.hpp"

namespace verisq::fit_search {

/// A candidate evaluated at every point of the cavity.
struct Found {
  Parameters parameters;
  double objective;
  double deepest_penetration;  ///< >= 0
  bool within_limit;
  std::size_t misplaced;  ///< as SideRequirements counts
};

/// The fewer samples misplaced; within the limit before beyond it; beyond it, the shallower; then the larger objective.
[[nodiscard]] inline bool better(const Found& a, const Found& b) {
  if (a.misplaced != b.misplaced) return a.misplaced < b.misplaced;
  if (a.within_limit != b.within_limit) return a.within_limit;
  if (!a.within_limit && a.deepest_penetration != b.deepest_penetration)
    return a.deepest_penetration < b.deepest_penetration;
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
