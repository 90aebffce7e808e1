/// A function sampled at the points of a lattice.
#pragma once

#include <array>
#include <cstddef>
#include <vector>
#include <verisq/model.hpp>

namespace verisq::surface {

/// Point (i, j, k) is origin + i steps[0] + j steps[1] + k steps[2], its value the one at `index(i, j, k)`. Steps are
/// linearly independent.
struct GridSamples {
  std::array<std::size_t, 3> counts;
  Point origin;
  std::array<Point, 3> steps;
  std::vector<float> values;

  [[nodiscard]] std::size_t index(std::size_t i, std::size_t j, std::size_t k) const {
    return i + counts[0] * (j + counts[1] * k);
  }
  [[nodiscard]] Point point(std::size_t i, std::size_t j, std::size_t k) const {
    Point x = origin;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      x[axis] += static_cast<double>(i) * steps[0][axis] + static_cast<double>(j) * steps[1][axis] +
                 static_cast<double>(k) * steps[2][axis];
    }
    return x;
  }
};

}  // namespace verisq::surface
