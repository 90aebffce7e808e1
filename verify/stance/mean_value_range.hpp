/// Ranges of differentiable functions over boxes, by mean-value forms and bisection: exact up to rounding where the
/// derivatives have proven signs (docs/stance.md §5).
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <verisq/enclosure.hpp>

#include "verify/stance/box_division.hpp"

namespace verisq::stance {

/// Enclosures of a function and its partial derivatives over boxes.
struct DifferentiableFunction {
  std::function<verify::Interval(std::span<const verify::Interval> box)> value;
  std::function<verify::Interval(std::span<const verify::Interval> box, std::uint32_t variable)> partial;
};

/// Contains all values over the box; `variables` are the box's coordinates that are not points.
[[nodiscard]] Enclosure range(const DifferentiableFunction& function, const Box& box,
                              std::span<const std::uint32_t> variables);

}  // namespace verisq::stance
