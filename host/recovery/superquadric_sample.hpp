/// Points spread evenly over the surface of a shape.
#pragma once

#include <Eigen/Core>
#include <random>
#include <span>
#include <vector>

#include "host/recovery/shape.hpp"

namespace verisq::recovery {

/// In [0, 1). std::mt19937_64 is fixed by the standard, its distributions are not.
[[nodiscard]] inline double fraction(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11) * 0x1p-53;
}

/// `count` independent points, uniform by area where the shape is neither tapered nor bent: directions are drawn, and
/// kept in proportion to the area that they stand for. Tapers and bends then move them.
[[nodiscard]] std::vector<Eigen::Vector3d> sample_surface(const Shape& shape, std::size_t count,
                                                          std::mt19937_64& random);

/// At most about `count` points of the union's surface: those of its primitives that lie in no other.
[[nodiscard]] std::vector<Eigen::Vector3d> sample_union(std::span<const Shape> shapes, std::size_t count,
                                                        std::mt19937_64& random);

}  // namespace verisq::recovery
