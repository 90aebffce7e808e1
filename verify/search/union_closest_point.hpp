/// The closest point of the surface of a union of convex primitives.
#pragma once

#include <optional>
#include <span>

#include "verify/search/convex_primitive.hpp"
#include "verisq/closest_point.hpp"

namespace verisq::verify {

/// What single primitives prove (docs/mathematics.md §25); nothing where they decide neither the distance nor the
/// point: inside, where they overlap. Outside, of several primitives that may be the nearest, the hull of their boxes.
[[nodiscard]] std::optional<ClosestPoint> closest_point(std::span<const ConvexPrimitive> primitives, const Point& x);

}  // namespace verisq::verify
