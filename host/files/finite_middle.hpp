/// The number by which maps colour a row.
#pragma once

#include <cmath>
#include <numeric>

namespace verisq {

/// A finite number inside the enclosure: the middle; where one end is infinite the other end; where both are, 0. Never
/// NaN.
[[nodiscard]] inline double finite_middle(double lo, double hi) {
  if (std::isfinite(lo) && std::isfinite(hi)) return std::midpoint(lo, hi);
  if (std::isfinite(lo)) return lo;
  return std::isfinite(hi) ? hi : 0.0;
}

}  // namespace verisq
