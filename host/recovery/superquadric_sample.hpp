/// Points spread evenly over the surface of a shape.
#pragma once

#include <Eigen/Core>
#include <random>
#include <vector>

#include "host/recovery/shape.hpp"

namespace verisq::recovery {

/// In [0, 1). std::mt19937_64 is fixed by the standard, its distributions are not.
[[nodiscard]] inline double fraction(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11) * 0x1p-53;
}

/// `count` independent points, uniform by area on an untapered, straight shape: directions are drawn, and kept in
/// proportion to the area that they stand for.
[[nodiscard]] std::vector<Eigen::Vector3d> sample_surface(const Shape& shape, std::size_t count,
                                                          std::mt19937_64& random);

}  // namespace verisq::recovery
