/// Decides exactly whether a triangle has zero area.
#pragma once

#include <verisq/model.hpp>

namespace verisq {

/// True if and only if the real area of the triangle with exactly these corners is zero: two corners are equal or all
/// three lie on a line. Never true because of rounding, underflow or overflow. Precondition: finite corners.
[[nodiscard]] bool has_zero_area(const Point& a, const Point& b, const Point& c);

}  // namespace verisq
