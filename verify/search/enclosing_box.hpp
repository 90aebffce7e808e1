/// Boxes of points in interval arithmetic: what two of them say together, and their binary64 form.
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

#include "verify/numbers/vector.hpp"
#include "verify/proof/intersection.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

[[nodiscard]] inline Enclosure rounded_outward(const PreciseInterval& x) {
  return {x.lower().to_double(Direction::down), x.upper().to_double(Direction::up)};
}

[[nodiscard]] inline std::array<Enclosure, 3> rounded_outward(const PreciseVector& box) {
  return {rounded_outward(box[0]), rounded_outward(box[1]), rounded_outward(box[2])};
}

/// Both contain the same number, which `what` names; throws Error(failure) where they have nothing in common.
[[nodiscard]] inline PreciseInterval intersection(const PreciseInterval& x, const PreciseInterval& y,
                                                  std::string_view what) {
  const Real lower = std::max(x.lower(), y.lower());
  const Real upper = std::min(x.upper(), y.upper());
  if (!(lower <= upper)) report_contradiction(rounded_outward(x), rounded_outward(y), std::string(what));
  return {lower, upper};
}

/// Both contain the same point.
[[nodiscard]] inline PreciseVector intersection(const PreciseVector& x, const PreciseVector& y, std::string_view what) {
  return {intersection(x[0], y[0], what), intersection(x[1], y[1], what), intersection(x[2], y[2], what)};
}

[[nodiscard]] inline bool subset(const PreciseInterval& inner, const PreciseInterval& outer) {
  return outer.lower() <= inner.lower() && inner.upper() <= outer.upper();
}

/// All points at most `radius` from one of the box in every coordinate.
[[nodiscard]] inline PreciseVector inflated(const PreciseVector& box, const Real& radius) {
  const PreciseInterval about(-radius, radius);
  return {box[0] + about, box[1] + about, box[2] + about};
}

/// The lower ends: a single point, for proposals.
[[nodiscard]] inline PreciseVector thin(const PreciseVector& x) {
  return {x[0].lower(), x[1].lower(), x[2].lower()};
}

}  // namespace verisq::verify
