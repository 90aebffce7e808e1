/// How tight the methods get: what a tolerance of 0 asks for, and calls verified.
#pragma once

#include <algorithm>
#include <verisq/enclosure.hpp>

#include "host/mesh/largest_coordinate.hpp"

namespace verisq {

// Outside, the device's certificates are as good as certificates get; inside, its branch and bound is.
inline constexpr double tightest_outside = 1e-12;  // of max(largest |coordinate|, radius of the model)
inline constexpr double tightest_inside = 2e-9;    // of the radius of the model

/// The width of the tightest enclosures of a signed distance like `found`; of triangles, `found` is never below 0.
template <class Query>
[[nodiscard]] double tightest_width(const Query& query, const Enclosure& found, double radius) {
  if (found.lo < 0.0) return tightest_inside * radius;
  return tightest_outside * std::max(largest_coordinate(query), radius);
}

}  // namespace verisq
