/// How large the numbers of a point or triangle are: what roundings are in proportion to.
#pragma once

#include <algorithm>
#include <cmath>

#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// Precondition: finite.
[[nodiscard]] inline double largest_coordinate(const Point& point) {
  double largest = 0.0;
  for (const double c : point) largest = std::max(largest, std::abs(c));
  return largest;
}

/// Of its corners; likewise.
[[nodiscard]] inline double largest_coordinate(const Triangle& triangle) {
  double largest = 0.0;
  for (const Point& corner : triangle) largest = std::max(largest, largest_coordinate(corner));
  return largest;
}

}  // namespace verisq::verify
