/// What is asked of two models at the moments of a path.
#pragma once

#include <cstddef>

#include "verisq/enclosure.hpp"

namespace verisq::verify {

/// Of one leg; both ends are exact binary64 numbers, as is the middle of what may still be halved.
struct Stretch {
  std::size_t leg;
  double begin, end;         ///< times of the path
  double lower = -infinity;  ///< of the distance, at all its times

  [[nodiscard]] double middle() const { return 0.5 * (begin + end); }
  [[nodiscard]] double reach() const { return 0.5 * (end - begin); }
};

/// What was found at the middle of a stretch.
struct Moment {
  double time;
  double lower;  ///< over the stretch
  double upper;  ///< at the middle; 0 where a common point is proven
};

/// Two models, one of which moves.
class PathMoments {
 public:
  PathMoments() = default;
  PathMoments(const PathMoments&) = delete;
  PathMoments& operator=(const PathMoments&) = delete;
  virtual ~PathMoments() = default;

  /// Where the distance is proven to be more than `enough`, at all times of the stretch, nothing closer is asked.
  [[nodiscard]] virtual Moment examine(const Stretch& stretch, double enough) const = 0;
};

}  // namespace verisq::verify
