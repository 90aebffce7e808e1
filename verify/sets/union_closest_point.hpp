/// The closest point of the surface of a union of primitives, bent ones among them or not.
#pragma once

#include <optional>
#include <span>

#include "verify/search/convex_primitive.hpp"
#include "verify/sets/union_part.hpp"
#include "verisq/closest_point.hpp"

namespace verisq::verify {

/// What single primitives prove (docs/mathematics.md §25); nothing where they decide neither the distance nor the
/// point: inside, where they overlap. Outside, of several primitives that may be the nearest, the hull of their boxes.
[[nodiscard]] std::optional<ClosestPoint> closest_point(std::span<const ConvexPrimitive> primitives, const Point& x);

/// Likewise; nothing, too, where a bent one proves nothing: inside it, and where its certificate (§9) does not hold.
[[nodiscard]] std::optional<ClosestPoint> closest_point(std::span<const UnionPart> parts, const Point& x);

}  // namespace verisq::verify
