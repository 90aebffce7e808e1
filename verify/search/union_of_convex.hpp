/// Unions of primitives: distances, closest points, certificates.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <variant>

#include "verify/proof/exact_checker.hpp"
#include "verify/search/bent_distance.hpp"
#include "verify/search/closest_surface_point.hpp"
#include "verify/search/convex_primitive.hpp"
#include "verisq/checker.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

// Signed distance of a union of primitives: exact outside, an honest enclosure where primitives overlap.

/// With what proves it. Precondition: at least one primitive.
[[nodiscard]] CertifiedEnclosure signed_distance(std::span<const ConvexPrimitive> primitives, const Point& x,
                                                 double tolerance);

// One primitive of a model, convex or bent, and what it says alone of a point.

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

// The closest point of the surface of a union of primitives, bent ones among them or not.

/// What single primitives prove (docs/mathematics.md §25); nothing where they decide neither the distance nor the
/// point: inside, where they overlap. Outside, of several primitives that may be the nearest, the hull of their boxes.
[[nodiscard]] std::optional<ClosestPoint> closest_point(std::span<const ConvexPrimitive> primitives, const Point& x);

/// Likewise; nothing, too, where a bent one proves nothing: inside it, and where its certificate (§9) does not hold.
[[nodiscard]] std::optional<ClosestPoint> closest_point(std::span<const UnionPart> parts, const Point& x);

// Signed distances to unions with bent primitives, with what proves them.

/// What one part, the model's primitive `index`, proves alone.
[[nodiscard]] CertifiedEnclosure certificate_of_part(const UnionPart& part, std::uint32_t index, const Point& x);

/// Asked for where x may lie inside: a point outside the union, hardly farther than any is.
using FindEscape = std::function<std::optional<Point>()>;

/// The enclosure is what `checker`, of the same model, proves: tight outside where the condition of docs/mathematics.md
/// §9 holds, inside where that ball's proof does; elsewhere, and once `interrupted`, valid, and wide.
[[nodiscard]] CertifiedEnclosure bent_union_certificate(std::span<const UnionPart> parts, const ExactChecker& checker,
                                                        const Point& x, const FindEscape& find_escape,
                                                        const std::function<bool()>& interrupted);

}  // namespace verisq::verify
