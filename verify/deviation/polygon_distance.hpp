/// How far the points of a small polygon lie from many triangles, at most: the polygon is cut along the sides of the
/// triangles that it lies over (docs/mathematics.md §20).
#pragma once

#include <cstdint>
#include <span>

#include "verify/deviation/triangle_tree.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// An upper bound of the distance from the triangles over the convex hull of three points, that tries no harder than to
/// come below `enough`. `first`: a triangle to begin with.
[[nodiscard]] double farthest_of_polygon(std::span<const Point, 3> corners, const TriangleTree& triangles,
                                         std::uint32_t first, double enough);

}  // namespace verisq::verify
