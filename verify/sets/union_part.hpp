/// One primitive of a model, convex or bent, and what it says alone of a point.
#pragma once

#include <variant>

#include "verify/search/closest_surface_point.hpp"
#include "verify/search/convex_primitive.hpp"
#include "verify/sets/bent_distance.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

using UnionPart = std::variant<ConvexPrimitive, BentDistance>;

[[nodiscard]] UnionPart part_of(const Primitive& primitive);

/// Of the signed distance, which is at least that to a ball around the primitive; rounded down.
[[nodiscard]] double lower_by_sphere(const UnionPart& part, const Point& x);
[[nodiscard]] double lower_by_sphere(const ConvexPrimitive& part, const Point& x);

/// Contains the signed distance of a convex one to a thousandth of its radius, of a bent one that is not negative. How
/// rough only costs time: where two are as near as each other, the closest point of both is looked for.
[[nodiscard]] Enclosure rough_distance(const UnionPart& part, const Point& x);
[[nodiscard]] Enclosure rough_distance(const ConvexPrimitive& part, const Point& x);

/// docs/mathematics.md §25. Where nothing is proven, as inside bent ones, anywhere.
[[nodiscard]] ClosestSurfacePoint closest_surface_point(const UnionPart& part, const Point& x);
[[nodiscard]] ClosestSurfacePoint closest_surface_point(const ConvexPrimitive& part, const Point& x);

/// Whether all points of a box of the model's frame are proven to lie outside.
[[nodiscard]] bool excludes(const UnionPart& part, const PreciseVector& box);
[[nodiscard]] bool excludes(const ConvexPrimitive& part, const PreciseVector& box);

}  // namespace verisq::verify
