/// Signed distance of a union of primitives: exact outside, an honest enclosure where primitives overlap.
#pragma once

#include <span>

#include "verify/search/convex_primitive.hpp"
#include "verisq/certificate.hpp"

namespace verisq::verify {

/// With what proves it. Precondition: at least one primitive.
[[nodiscard]] CertifiedEnclosure signed_distance(std::span<const ConvexPrimitive> primitives, const Point& x,
                                                 double tolerance);

}  // namespace verisq::verify
