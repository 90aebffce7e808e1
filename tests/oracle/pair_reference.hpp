/// The test oracle for two posed convex superquadrics: their exact distance, by MPFR at 200 bits, proven from both
/// sides by duality; independent of verify/ and kernels/ but for the mathematics.
#pragma once

#include <optional>

#include "tests/oracle/reference_distance.hpp"

namespace verisq::oracle {

/// lower <= distance <= upper, both proven, whatever the search found: lower by (v·c - h_A(v) - h_B(-v))/|v|, upper by
/// two points of the solids. A search that fails leaves a wide gap, never a wrong one.
struct PairReference {
  Real lower;
  Real upper;
  Vector on_a;  ///< in A, in the common frame
  Vector on_b;
  /// An estimate, not proven: how far from on_a and on_b a pair of closest points is. Empty where either solid is
  /// nearly flat there: the distance then says too little about where it is attained.
  std::optional<Real> reach;
  std::optional<Vector> common;  ///< proven to lie in both solids: the distance is 0
};

[[nodiscard]] PairReference reference_distance(const PosedSolid& a, const PosedSolid& b);

}  // namespace verisq::oracle
