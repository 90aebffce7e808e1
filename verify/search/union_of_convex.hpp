/// Unions of primitives: distances, closest points, certificates.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <variant>

#include "verify/proof/exact_checker.hpp"
#include "verify/search/bent_distance.hpp"
#include "verify/search/convex_primitive.hpp"
#include "verisq/checker.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

// Signed distance of a union of primitives: exact outside, an honest enclosure where primitives overlap.

/// The signed distance with its certificate. Precondition: at least one primitive.
[[nodiscard]] CertifiedEnclosure signed_distance(std::span<const ConvexPrimitive> primitives, const Point& x,
                                                 double tolerance);

// One primitive of a model, convex or bent, and the bounds that it alone gives for a point.

using UnionPart = std::variant<ConvexPrimitive, BentDistance>;

[[nodiscard]] UnionPart part_of(const Primitive& primitive);

/// A lower bound of the signed distance, by the distance to a ball around the primitive; rounded down.
[[nodiscard]] double lower_by_sphere(const UnionPart& part, const Point& x);
[[nodiscard]] double lower_by_sphere(const ConvexPrimitive& part, const Point& x);

/// Contains the signed distance of a convex primitive to a thousandth of its radius, or the nonnegative distance of a
/// bent one. The roughness only costs time: if two primitives are equally near, the closest points of both are
/// computed.
[[nodiscard]] Enclosure rough_distance(const UnionPart& part, const Point& x);
[[nodiscard]] Enclosure rough_distance(const ConvexPrimitive& part, const Point& x);

/// docs/mathematics.md §25. If nothing is proven, as inside bent primitives, the point may be anywhere.
[[nodiscard]] ClosestSurfacePoint closest_surface_point(const UnionPart& part, const Point& x);
[[nodiscard]] ClosestSurfacePoint closest_surface_point(const ConvexPrimitive& part, const Point& x);

/// Returns whether all points of a box of the model's frame are proven to lie outside.
[[nodiscard]] bool excludes(const UnionPart& part, const PreciseVector& box);
[[nodiscard]] bool excludes(const ConvexPrimitive& part, const PreciseVector& box);

// The closest point of the surface of a union of primitives, bent ones among them or not.

/// The closest point that single primitives prove (docs/mathematics.md §25). Nothing if they decide neither the
/// distance nor the point: inside, where they overlap. Outside, if several primitives may be the nearest, the hull of
/// their boxes.
[[nodiscard]] std::optional<ClosestPoint> closest_point(std::span<const ConvexPrimitive> primitives, const Point& x);

/// The same; nothing, too, if a bent primitive proves nothing: inside it, and if its certificate (§9) does not hold.
[[nodiscard]] std::optional<ClosestPoint> closest_point(std::span<const UnionPart> parts, const Point& x);

// Signed distances to unions with bent primitives, with their certificates.

/// The enclosure that one part, the model's primitive `index`, proves alone.
[[nodiscard]] CertifiedEnclosure certificate_of_part(const UnionPart& part, std::uint32_t index, const Point& x);

/// Called if x may lie inside: returns a point outside the union, hardly farther than the nearest such point.
using FindEscape = std::function<std::optional<Point>()>;

/// The checker `checker`, of the same model, proves the enclosure. It is tight outside if the condition of
/// docs/mathematics.md §9 holds, inside if that section's ball is proven. Elsewhere, and once `interrupted` returns
/// true, it is valid, and wide.
[[nodiscard]] CertifiedEnclosure bent_union_certificate(std::span<const UnionPart> parts, const ExactChecker& checker,
                                                        const Point& x, const FindEscape& find_escape,
                                                        const std::function<bool()>& interrupted);

}  // namespace verisq::verify
