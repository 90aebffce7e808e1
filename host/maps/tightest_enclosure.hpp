/// How tight the methods get: what a tolerance of 0 asks for, and calls verified.
#pragma once

#include <algorithm>
#include <verisq/enclosure.hpp>

#include "verify/analysis/largest_coordinate.hpp"

namespace verisq {

// Outside, the device's certificates are as good as certificates get; inside, its branch and bound is.
inline constexpr double tightest_outside = 1e-12;  // of max(largest |coordinate|, radius of the model)
inline constexpr double tightest_inside = 2e-9;    // of the radius of the model
// Of a tapered solid the kernels search once for the closest point: where that goes astray, for a few of 1000, the host
// is tighter.
inline constexpr double tightest_outside_of_tapered = 1e-14;

/// The width of the tightest enclosures of a signed distance like `found`. Only a point proven to be inside may be as
/// wide as those inside are: of one within rounding of the surface, certificates enclose the distance as outside.
template <class Query>
[[nodiscard]] double tightest_width(const Query& query, const Enclosure& found, double radius,
                                    double outside = tightest_outside) {
  if (found.hi < 0.0) return tightest_inside * radius;
  return outside * std::max(verify::largest_coordinate(query), radius);
}

}  // namespace verisq
