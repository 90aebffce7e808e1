/// Reproducible random triangles around a solid, with extra mass where proofs are hard.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <verisq/mesh.hpp>

#include "tests/oracle/random_cases.hpp"

namespace verisq::oracle {

/// How a triangle is placed relative to the solid. Most are built around a point p that lies outside a boundary point
/// along its normal, 1e-9 to 3 largest semi-axes away unless said otherwise.
enum class TriangleFamily : std::uint8_t {
  face,         ///< p inside the triangle, which is orthogonal to the normal
  edge,         ///< p on an edge orthogonal to the normal, the third corner farther out
  vertex,       ///< p a corner, the others farther out
  needle,       ///< three corners on a line through p, or nearly, or two of them equal
  large,        ///< a face of 10 to 1e4 sizes
  small,        ///< any of the first three, of 1e-9 to 1e-3 sizes
  touching,     ///< any of the first three, less than 1e-15 sizes away on either side
  penetrating,  ///< any of the first three, p up to one size inside
  far,          ///< any of the first three, 10 to 1e4 sizes away
  aligned,      ///< orthogonal to an axis of the solid's own frame
  anywhere,     ///< corners within 3 sizes of the centre
};

inline constexpr std::array triangle_families{
    TriangleFamily::face,  TriangleFamily::edge,    TriangleFamily::vertex,   TriangleFamily::needle,
    TriangleFamily::large, TriangleFamily::small,   TriangleFamily::touching, TriangleFamily::penetrating,
    TriangleFamily::far,   TriangleFamily::aligned, TriangleFamily::anywhere};

[[nodiscard]] std::string_view to_string(TriangleFamily family);

struct RandomTriangle {
  Triangle triangle;
  TriangleFamily family;
};

[[nodiscard]] RandomTriangle random_triangle(RandomCases& random, const Primitive& solid);

}  // namespace verisq::oracle
