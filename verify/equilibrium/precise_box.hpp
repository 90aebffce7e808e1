/// Boxes of 127-bit intervals, one side a variable.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "verify/numbers/interval.hpp"

namespace verisq::verify {

using PreciseBox = std::vector<PreciseInterval>;

[[nodiscard]] inline PreciseInterval exact(double number) {
  return PreciseInterval(Real(number));
}

[[nodiscard]] inline PreciseBox exact(std::span<const double> numbers) {
  PreciseBox result;
  for (const double number : numbers) result.push_back(exact(number));
  return result;
}

[[nodiscard]] inline bool lies_within(const PreciseBox& inner, const PreciseBox& outer) {
  return std::ranges::equal(
      inner, outer, [](const auto& a, const auto& b) { return a.lower() >= b.lower() && a.upper() <= b.upper(); });
}

/// Without a common end.
[[nodiscard]] inline bool lies_inside(const PreciseBox& inner, const PreciseBox& outer) {
  return std::ranges::equal(
      inner, outer, [](const auto& a, const auto& b) { return a.lower() > b.lower() && a.upper() < b.upper(); });
}

/// What lies in both. Throws std::domain_error where nothing does.
[[nodiscard]] inline PreciseBox common(const PreciseBox& a, const PreciseBox& b) {
  PreciseBox result;
  for (std::size_t i = 0; i < a.size(); ++i)
    result.emplace_back(std::max(a[i].lower(), b[i].lower()), std::min(a[i].upper(), b[i].upper()));
  return result;
}

/// A number of the side, where it holds one of binary64; else one next to it.
[[nodiscard]] inline double middle_of(const PreciseInterval& side) {
  const double lower = side.lower().to_double(Direction::up);
  const double upper = side.upper().to_double(Direction::down);
  return std::clamp(0.5 * lower + 0.5 * upper, std::min(lower, upper), std::max(lower, upper));
}

[[nodiscard]] inline std::vector<double> middles_of(std::span<const PreciseInterval> box) {
  std::vector<double> result;
  for (const PreciseInterval& side : box) result.push_back(middle_of(side));
  return result;
}

[[nodiscard]] inline PreciseInterval dot(std::span<const double> a, std::span<const PreciseInterval> b) {
  PreciseInterval sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] != 0.0) sum += exact(a[i]) * b[i];
  }
  return sum;
}

[[nodiscard]] inline PreciseInterval dot(std::span<const PreciseInterval> a, std::span<const PreciseInterval> b) {
  PreciseInterval sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace verisq::verify
