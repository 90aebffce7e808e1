/// The distance of a point from a triangle, enclosed by one pass in floating point (docs/mathematics.md §20).
#pragma once

#include "verisq/enclosure.hpp"
#include "verisq/mesh.hpp"

namespace verisq::verify {

/// Encloses the Euclidean distance from `point` to the closed triangle of exactly these corners, which may lie on a
/// line or coincide. Coordinates so large that squares overflow, and distances below 2^-500, get wide enclosures.
/// Precondition: finite.
[[nodiscard]] Enclosure distance_from_triangle(const Point& point, const Triangle& triangle);

/// Its upper end alone.
[[nodiscard]] double distance_from_triangle_up(const Point& point, const Triangle& triangle);

}  // namespace verisq::verify
