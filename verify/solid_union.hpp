/// Signed distance of a union of solids: exact outside, an honest enclosure where solids overlap.
#pragma once

#include <span>

#include "verify/solid.hpp"

namespace verisq::verify {

/// Precondition: at least one solid.
[[nodiscard]] Enclosure signed_distance(std::span<const Solid> solids, const Point& x, double tolerance);

}  // namespace verisq::verify
