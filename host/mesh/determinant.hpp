/// Of three axes: how large the box is that they span, and which hand they are of.
#pragma once

#include <array>
#include <verisq/model.hpp>

namespace verisq {

/// a·(b × c), to nearest: negative where they are left-handed.
[[nodiscard]] inline double determinant(const std::array<Point, 3>& axes) {
  const auto& [a, b, c] = axes;
  return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

}  // namespace verisq
