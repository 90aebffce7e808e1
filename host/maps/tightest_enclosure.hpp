/// How tight the methods get: what a tolerance of 0 asks for, and calls verified.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <verisq/enclosure.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq {

// Outside, the device's certificates are as good as certificates get; inside, its branch and bound is.
inline constexpr double tightest_outside = 1e-12;  // of max(largest |coordinate|, radius of the model)
inline constexpr double tightest_inside = 2e-9;    // of the radius of the model

/// NaN if one is.
[[nodiscard]] inline double largest_coordinate(const Point& point) {
  double largest = 0.0;
  for (const double c : point) largest = std::isnan(c) ? c : std::max(std::abs(c), largest);
  return largest;
}

[[nodiscard]] inline double largest_coordinate(const Triangle& triangle) {
  double largest = 0.0;
  for (const Point& p : triangle) {
    const double c = largest_coordinate(p);
    largest = std::isnan(c) || std::isnan(largest) ? c + largest : std::max(c, largest);
  }
  return largest;
}

/// The width of the tightest enclosures of a signed distance like `found`; of triangles, `found` is never below 0.
template <class Query>
[[nodiscard]] double tightest_width(const Query& query, const Enclosure& found, double radius) {
  if (found.lo < 0.0) return tightest_inside * radius;
  return tightest_outside * std::max(largest_coordinate(query), radius);
}

}  // namespace verisq
