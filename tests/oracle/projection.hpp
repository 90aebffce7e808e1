/// Certified distance of a point outside one convex superquadric, in its own frame, at 200 bits.
#pragma once

#include "tests/oracle/mixed_norm.hpp"

namespace verisq::oracle {

/// lower <= exact value <= upper, but for the rounding at 200 bits that the caller adds.
struct Bounds {
  Real lower;
  Real upper;
};

/// With a point of the solid that is as far from q as `distance.upper` says. As the solid is convex, the closest point
/// lies within sqrt(upper² - lower²) of it: the angle at the closest point, between the two, is not acute.
struct ProjectedPoint {
  Bounds distance;
  Vector point;
};

/// Finds the closest point b (Newton at 200 bits from a start in double; nested root searches where that fails) and
/// proves the distance by the duality gap of docs/mathematics.md §2: (v·q - h(v))/|v| <= distance <= |q - b|. A search
/// that fails leaves a wide gap, never a wrong one. Precondition: q >= 0 and g(q) > 1.
[[nodiscard]] ProjectedPoint project_from_outside(const Superquadric& superquadric, const MixedNorm<Real>& norm,
                                                  const Vector& q);

}  // namespace verisq::oracle
