/// How far triangles are from a solid's surface, at points of them: an estimate, which proves nothing.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "host/tessellation/solid.hpp"
#include "host/tessellation/triangle_shape.hpp"

namespace verisq::tessellation {

/// Of the points of a triangle: weights in steps of 1/`steps`, without the corners.
enum class Sampling : int { coarse = 2, usual = 3, fine = 6 };

/// How many points that are.
[[nodiscard]] constexpr std::size_t samples_of(Sampling sampling) {
  const auto steps = static_cast<std::size_t>(sampling);
  return (steps + 1) * (steps + 2) / 2 - 3 + (steps % 3 == 0 ? 0 : 1);
}

/// Whether points of the triangle are found to be at most `deviation` away from the surface.
[[nodiscard]] bool within(const Solid& solid, const TriangleCorners& triangle, double deviation, Sampling sampling);

/// The least of a sequence of bounds, each 1/8 above the one before from `least` on, that `within` finds to hold; at
/// most `most`.
[[nodiscard]] double sampled_deviation(const Solid& solid, const TriangleCorners& triangle, double least, double most,
                                       Sampling sampling);

}  // namespace verisq::tessellation
