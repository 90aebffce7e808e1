/// The answer of every query: an interval of binary64 numbers that contains the exact real result.
#pragma once

#include <algorithm>
#include <limits>

namespace verisq {

/// The end of an enclosure on whose side nothing is proven.
inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// `[lo, hi]` with `lo <= exact value <= hi`; either end may be infinite when nothing tighter is proven.
struct Enclosure {
  double lo;
  double hi;

  [[nodiscard]] constexpr double width() const { return hi - lo; }
  [[nodiscard]] constexpr bool contains(double value) const { return lo <= value && value <= hi; }
  [[nodiscard]] constexpr bool operator==(const Enclosure&) const = default;
};

/// The numbers of both, and those between.
[[nodiscard]] constexpr Enclosure hull(const Enclosure& a, const Enclosure& b) {
  return {std::min(a.lo, b.lo), std::max(a.hi, b.hi)};
}

/// "Verified" in the sense of docs/formats.md §1: at most `tolerance` wide. False for NaN, and for lo > hi, which
/// encloses nothing.
[[nodiscard]] constexpr bool verified(const Enclosure& e, double tolerance) {
  return e.lo <= e.hi && e.width() <= tolerance;
}

}  // namespace verisq
