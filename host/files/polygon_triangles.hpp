/// The exact orientation of three points, and the division of polygons into triangles by it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>
#include <verisq/model.hpp>

namespace verisq {

// Decides exactly the orientation of three points, and whether a triangle has zero area.

/// Two coordinates of points, in this order: their projection along the third axis.
using CoordinatePlane = std::array<std::size_t, 2>;

/// 1 if the triangle of exactly these corners runs anticlockwise in the plane, -1 if it runs clockwise, 0 if its
/// projection has no area. Never wrong because of rounding, underflow or overflow. Precondition: finite corners.
[[nodiscard]] int turn(const Point& a, const Point& b, const Point& c, const CoordinatePlane& plane);

/// True if and only if the real area of the triangle with exactly these corners is zero: two corners are equal or all
/// three lie on a line. As exact as `turn`. Precondition: finite corners.
[[nodiscard]] bool has_zero_area(const Point& a, const Point& b, const Point& c);

// Divides a polygon of a mesh file into triangles that cover its area, and nothing else.

/// Corners are positions in the polygon.
struct PolygonTriangles {
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< in the polygon's sense; none has zero area
  std::string defect = {};  ///< the reason why there are none, to follow "face N: "; else empty
};

/// A convex polygon becomes the fan around its first corner, however its corners are bent out of a plane: quadrangles
/// of CAD often are, and the fan determines the intended surface. (Not if it is bent by more than its size.) If a fan
/// would cover points outside or contain a triangle without area, ears are cut off. Such a polygon must be plane, as
/// far as roundings of its coordinates to six digits allow, and have at most 4,096 corners. Polygons that cross or
/// touch themselves have a defect. Precondition: at least four corners, finite.
[[nodiscard]] PolygonTriangles triangles_of_polygon(std::span<const Point> corners);

}  // namespace verisq
