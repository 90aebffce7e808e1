/// How points, rays and triangles of binary64 coordinates lie to each other: distances enclosed, sides exact.
#pragma once

#include <cstddef>
#include <optional>

#include "verify/search/triangle_bounds.hpp"
#include "verify/solids/closed_edges.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

using DistanceBounds = BoundsOfDistance<double>;

/// Preconditions: finite; differences no larger than 2^300. What lies below 2^-500 is wide.
[[nodiscard]] DistanceBounds distance_bounds(const Point& point, const Triangle& triangle);

// Signs are -1, 0 or 1. Filters in binary64 decide nearly all, MPFR with as many bits as any result can have the
// others. Preconditions: coordinates are finite; no larger than 2^300 where a filter is asked alone.

/// On which side of the plane through a, b and c the point lies: 1 where (b - a) × (c - a) points to.
[[nodiscard]] int orientation(const Triangle& triangle, const Point& point);

/// The same, where binary64 is enough for it; never 0.
[[nodiscard]] std::optional<int> near_orientation(const Triangle& triangle, const Point& point);

/// True where the corners lie on a line.
[[nodiscard]] bool is_degenerate(const Triangle& triangle);

/// True where the point lies on the closed triangle, which may be degenerate.
[[nodiscard]] bool lies_on(const Point& point, const Triangle& triangle);

/// Returns what a triangle adds to the winding number of a point: a ray from it along the axis, upward or downward,
/// meets the triangle and leaves through it along its normal (1), or against it (-1), or does not meet it. The ray is
/// moved aside by the same infinitely small step for all triangles, so that it meets no side (docs/mathematics.md §29).
/// Precondition: the point does not lie on the triangle.
[[nodiscard]] int crossing(const Point& point, std::size_t axis, bool upward, const Triangle& triangle);

/// True proves that the two triangles have no point in common but the hull of their common corners, and that these are
/// at most two.
[[nodiscard]] bool meet_in_common_corners(const Triangle& first, const Corners& of_first, const Triangle& second,
                                          const Corners& of_second);

}  // namespace verisq::verify
