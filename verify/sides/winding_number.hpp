/// How often a closed surface winds around a point, proven.
#pragma once

#include <optional>
#include <span>

#include "verisq/mesh.hpp"

namespace verisq::verify {

/// Of the triangles as their binary64 corners state them, which must be closed: every edge is run through as often one
/// way as the other. Outward triangles about the point count 1, inward ones -1; 0 outside. Nothing where rounding
/// leaves it open: the point lies on the surface, or all but does. Precondition: finite numbers.
[[nodiscard]] std::optional<int> winding_number(const Point& point, std::span<const Triangle> closed_surface);

}  // namespace verisq::verify
