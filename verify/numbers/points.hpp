/// Points of binary64: finite ones, largest coordinates, lengths.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "verisq/model.hpp"

namespace verisq::verify {

// Finiteness of a point's three coordinates.

[[nodiscard]] inline bool is_finite(const Point& x) {
  return std::isfinite(x[0]) && std::isfinite(x[1]) && std::isfinite(x[2]);
}

// The largest magnitude among the numbers of points: roundings are in proportion to it.

/// Precondition: finite.
[[nodiscard]] inline double largest_coordinate(const Point& point) {
  double largest = 0.0;
  for (const double c : point) largest = std::max(largest, std::abs(c));
  return largest;
}

/// The largest coordinate of all points, such as a triangle's corners. Precondition: finite.
[[nodiscard]] inline double largest_coordinate(std::span<const Point> points) {
  double largest = 0.0;
  for (const Point& point : points) largest = std::max(largest, largest_coordinate(point));
  return largest;
}

// The length of a vector of binary64 numbers, with a bound of its error that rests on correctly rounded operations
// alone.

/// Within 2^-50 of the Euclidean length, relatively, and 2^-1074; NaN or infinity if a component is, or on overflow.
/// Not std::hypot, whose accuracy depends on the library. Let u = 2^-53, and take quotients by the largest component m,
/// one of which is 1. Each quotient rounds by u, its square by u more, two sums by u each, so that their root is off by
/// 5u/2; root and product round by u each. These 9u/2 < 2^-50 leave room for the products of errors and for the squares
/// that underflow beside 1. A subnormal product rounds by 2^-1075.
[[nodiscard]] inline double length(double x, double y, double z) {
  const double m = std::max({std::fabs(x), std::fabs(y), std::fabs(z)});
  if (m == 0.0) return x + y + z;  // 0, or NaN
  const double a = x / m;
  const double b = y / m;
  const double c = z / m;
  return m * std::sqrt(a * a + b * b + c * c);
}

// Numbers scaled by a power of two, where only their ratios matter: directions, and quaternions of any length but 0.

/// The largest component lies in [2^e, 2^(e + 1)), also where it is subnormal. Precondition: finite, not all are 0.
template <std::size_t N>
[[nodiscard]] int exponent_of(const std::array<double, N>& numbers) {
  double largest = 0.0;
  for (const double x : numbers) largest = std::max(largest, std::abs(x));
  return std::ilogb(largest);
}

/// The same direction, scaled so that its largest component lies in [1, 2); the square of that can neither overflow nor
/// vanish.
///
/// A power of two changes no digit of a number that stays normal. Here no number gets larger than 2, so that none
/// overflows. A number below 2^-1022 is rounded by at most 2^-1075, beside a component of at least 1. So the direction
/// turns by less than 2^-1073, far less than by a single rounding of any square, product or root. Precondition: finite,
/// not all are 0.
template <std::size_t N>
[[nodiscard]] std::array<double, N> near_one(const std::array<double, N>& numbers) {
  std::array<double, N> scaled{};
  std::ranges::transform(numbers, scaled.begin(),
                         [down = -exponent_of(numbers)](double x) { return std::ldexp(x, down); });
  return scaled;
}

}  // namespace verisq::verify
