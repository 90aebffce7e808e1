/// Proven lower bounds of distances to a cube cut by half-spaces, by Lagrange multipliers.
#pragma once

#include <optional>
#include <span>

#include "verify/sets/cube.hpp"

namespace verisq::verify {

struct PolytopeDistance {
  double lower;   ///< proven; infinite where the polytope is proven empty
  Point nearest;  ///< to the query, about: proves nothing
};

/// Distance of x to the part of the cube in all half-spaces. Any multipliers m_j >= 0 prove
/// |e - x|^2 >= min over the cube of |e - x|^2 + 2 sum m_j (n_j.e - b_j), which is a sum over the coordinates.
[[nodiscard]] PolytopeDistance polytope_distance(const Point& x, const Cube& cube,
                                                 std::span<const HalfSpace> half_spaces);

}  // namespace verisq::verify
