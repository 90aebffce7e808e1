/// Signed distance of a union of solids: exact outside, an honest enclosure where solids overlap.
#pragma once

#include <span>

#include "verify/search/solid.hpp"
#include "verisq/certificate.hpp"

namespace verisq::verify {

/// With what proves it. Precondition: at least one solid.
[[nodiscard]] CertifiedEnclosure signed_distance(std::span<const Solid> solids, const Point& x, double tolerance);

}  // namespace verisq::verify
