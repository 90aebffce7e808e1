/// Which way three points turn, exactly, and polygons cut into triangles by it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>
#include <verisq/model.hpp>

namespace verisq {

// Decides exactly which way three points turn, and whether a triangle has zero area.

/// Two coordinates of points, in this order: what is left of them seen along the third axis.
using CoordinatePlane = std::array<std::size_t, 2>;

/// 1 where the triangle of exactly these corners runs anticlockwise in the plane, -1 where it runs clockwise, 0 where
/// its shadow there has no area. Never wrong because of rounding, underflow or overflow. Precondition: finite corners.
[[nodiscard]] int turn(const Point& a, const Point& b, const Point& c, const CoordinatePlane& plane);

/// True if and only if the real area of the triangle with exactly these corners is zero: two corners are equal or all
/// three lie on a line. As exact as `turn`. Precondition: finite corners.
[[nodiscard]] bool has_zero_area(const Point& a, const Point& b, const Point& c);

// Cuts a polygon of a mesh file into triangles that cover what it bounds, and nothing else.

/// Corners are positions in the polygon.
struct PolygonTriangles {
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< in the polygon's sense; none has zero area
  std::string defect = {};                              ///< why there are none, to follow "face N: "; else empty
};

/// A convex polygon becomes the fan around its first corner, however its corners are bent out of a plane: quadrangles
/// of CAD often are, and the fan says which surface is meant. (Not if it is bent by more than its size.) Where a fan
/// would cover what is outside or hold a triangle without area, ears are cut off: such a polygon must be plane, as far
/// as roundings of its coordinates to six digits allow, and have at most 4,096 corners. Polygons that cross or touch
/// themselves have a defect. Precondition: at least four corners, finite.
[[nodiscard]] PolygonTriangles triangles_of_polygon(std::span<const Point> corners);

}  // namespace verisq
