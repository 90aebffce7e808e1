/// The test oracle for a triangle and a posed convex superquadric: their exact distance, by MPFR at 200 bits, proven
/// from both sides by duality; independent of verify/ and kernels/ but for the mathematics.
#pragma once

#include <optional>
#include <verisq/mesh.hpp>

#include "tests/oracle/reference_distance.hpp"

namespace verisq::oracle {

/// lower <= distance <= upper, both proven, whatever the search found: lower by (min_i v·t_i - h(v))/|v|, upper by a
/// point of the triangle and a point of the solid. A search that fails leaves a wide gap, never a wrong one.
struct TriangleReference {
  Real lower;
  Real upper;
  Vector on_triangle;
  Vector on_solid;
  std::optional<Vector> common;  ///< proven to lie in the triangle and the solid: the distance is 0
};

/// The triangle may be degenerate.
[[nodiscard]] TriangleReference reference_distance(const PosedSolid& solid, const Triangle& triangle);

}  // namespace verisq::oracle
