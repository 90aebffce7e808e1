/// Witnesses (docs/mathematics.md §28): points proven to lie in a solid, or beyond it, hardly farther than any are.
#pragma once

#include <functional>
#include <optional>

#include "verify/sets/solid_distance.hpp"

namespace verisq::verify {

/// By at most `tolerance` farther from x; nothing where none was found.
[[nodiscard]] std::optional<Point> nearest_witness(const SolidDistance& search, const Point& x, Side side,
                                                   double tolerance, const std::function<bool()>& interrupted);

}  // namespace verisq::verify
