/// Solids of revolution: their distance depends on two coordinates only.
#pragma once

#include <array>

#include "verify/numbers/vector.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// A superquadric and a point in the octant of nonnegative coordinates, with an axis of revolution, if any, as z, which
/// is also the axis of a taper; of a tapered solid z keeps its sign.
struct RevolvedPoint {
  Superquadric solid;
  PreciseVector q;
  bool planar;                       ///< q[1] is 0, and balls about q that lie inside do so by the section y = 0
  std::array<std::size_t, 3> order;  ///< coordinate k is coordinate order[k] of the original
};

/// Brings the axis of an ellipsoid of revolution to z; an ellipsoid's coordinates may be exchanged freely.
[[nodiscard]] inline std::array<std::size_t, 3> revolution_order(const Superquadric& solid) {
  const auto& a = solid.semi_axes;
  if (is_tapered(solid) || solid.exponents != std::array<double, 2>{1.0, 1.0} || a[0] == a[1]) return {0, 1, 2};
  if (a[1] == a[2]) return {1, 2, 0};
  if (a[0] == a[2]) return {2, 0, 1};
  return {0, 1, 2};
}

/// Why the section decides: the gauge rises with x and y through their length alone, and the length of (x + u, y + v)
/// is at most |(x, y)| + |(u, v)|, so that the ball lies inside if the disc about (|(x, y)|, 0, z) in y = 0 does.
[[nodiscard]] inline RevolvedPoint revolved(const Superquadric& solid, const PreciseVector& q) {
  RevolvedPoint result{solid, {}, false, revolution_order(solid)};
  for (std::size_t k = 0; k < 3; ++k) {
    result.solid.semi_axes[k] = solid.semi_axes[result.order[k]];
    result.q[k] = k == 2 && is_tapered(solid) ? q[k] : abs(q[result.order[k]]);
  }
  result.planar = result.solid.semi_axes[0] == result.solid.semi_axes[1] && solid.exponents[1] == 1.0;
  if (result.planar) {
    result.q[0] = sqrt(square(result.q[0]) + square(result.q[1]));
    result.q[1] = 0;
  }
  return result;
}

}  // namespace verisq::verify
