/// Reproducible random triangles around a superquadric, of the size that a mesh has there.
#pragma once

#include <cstddef>
#include <vector>
#include <verisq/mesh.hpp>

#include "bench/points.hpp"
#include "bench/uniform_numbers.hpp"

namespace verisq::bench {

/// A corner uniform in the box of three times the semi-axes, the others within a tenth of the size of it on each axis.
/// Some meet the solid. The sequence depends on the arguments alone.
[[nodiscard]] inline std::vector<Triangle> random_triangles(const Superquadric& solid, std::size_t count) {
  UniformNumbers uniform(20'110'504);
  const double edge = 0.1 * size_of(solid);
  std::vector<Triangle> triangles(count);
  for (auto& [first, second, third] : triangles) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      first[axis] = uniform.within(3.0 * solid.semi_axes[axis]);
      second[axis] = first[axis] + uniform.within(edge);
      third[axis] = first[axis] + uniform.within(edge);
    }
  }
  return triangles;
}

}  // namespace verisq::bench
