/// The box around points.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <verisq/model.hpp>

namespace verisq {

/// Everything is finite for finite points, also where sizes would overflow.
struct Extent {
  Point lower{};
  Point upper{};

  [[nodiscard]] Point centre() const {
    return {lower[0] / 2.0 + upper[0] / 2.0, lower[1] / 2.0 + upper[1] / 2.0, lower[2] / 2.0 + upper[2] / 2.0};
  }
  /// Half of the longest side.
  [[nodiscard]] double half_size() const {
    double half = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) half = std::max(half, upper[axis] / 2.0 - lower[axis] / 2.0);
    return half;
  }
  [[nodiscard]] double half_diagonal() const {
    return std::hypot(upper[0] / 2.0 - lower[0] / 2.0, upper[1] / 2.0 - lower[1] / 2.0,
                      upper[2] / 2.0 - lower[2] / 2.0);
  }
};

/// At the origin for no points at all.
[[nodiscard]] inline Extent extent_of(std::span<const Point> points) {
  if (points.empty()) return {};
  Extent extent{points.front(), points.front()};
  for (const Point& point : points) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      extent.lower[axis] = std::min(extent.lower[axis], point[axis]);
      extent.upper[axis] = std::max(extent.upper[axis], point[axis]);
    }
  }
  return extent;
}

}  // namespace verisq
