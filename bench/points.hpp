/// Reproducible random points around and inside a superquadric: every tool of the bench answers the same ones.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>
#include <verisq/model.hpp>

#include "bench/uniform_numbers.hpp"

namespace verisq::bench {

/// The largest semi-axis: the "size" by which tolerances and widths are scaled.
[[nodiscard]] inline double size_of(const Superquadric& solid) {
  return std::ranges::max(solid.semi_axes);
}

/// The gauge g of docs/mathematics.md §1, in plain floating point: above 1 outside, below 1 inside. Good enough to sort
/// points.
[[nodiscard]] inline double approximate_gauge(const Superquadric& solid, const Point& point) {
  const double p1 = 2.0 / solid.exponents[0];
  const double p2 = 2.0 / solid.exponents[1];
  const double x = std::abs(point[0] / solid.semi_axes[0]);
  const double y = std::abs(point[1] / solid.semi_axes[1]);
  const double z = std::abs(point[2] / solid.semi_axes[2]);
  const double largest = std::max({x, y, z});
  if (largest == 0.0) return 0.0;
  const double section = std::pow(std::pow(x / largest, p2) + std::pow(y / largest, p2), 1.0 / p2);
  return largest * std::pow(std::pow(section, p1) + std::pow(z / largest, p1), 1.0 / p1);
}

enum class Side { inside, outside };

/// `count` points on the given side, uniform in the box of `scale` times the semi-axes. The sequence depends on the
/// arguments alone.
[[nodiscard]] inline std::vector<Point> random_points(const Superquadric& solid, Side side, std::size_t count,
                                                      std::uint64_t seed, double scale) {
  UniformNumbers uniform(seed);
  std::vector<Point> points;
  points.reserve(count);
  while (points.size() < count) {
    Point point{};
    for (std::size_t axis = 0; axis < 3; ++axis) point[axis] = uniform.within(scale * solid.semi_axes[axis]);
    const bool is_outside = approximate_gauge(solid, point) > 1.0;
    if (is_outside == (side == Side::outside)) points.push_back(point);
  }
  return points;
}

[[nodiscard]] inline std::vector<Point> points_outside(const Superquadric& solid, std::size_t count) {
  return random_points(solid, Side::outside, count, 20'110'501, 3.0);
}

[[nodiscard]] inline std::vector<Point> points_inside(const Superquadric& solid, std::size_t count) {
  return random_points(solid, Side::inside, count, 20'110'502, 1.0);
}

}  // namespace verisq::bench
