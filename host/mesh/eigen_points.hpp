/// Points as Eigen's vectors, and back.
#pragma once

#include <Eigen/Core>
#include <verisq/model.hpp>

namespace verisq {

[[nodiscard]] inline Eigen::Vector3d vector_of(const Point& p) {
  return {p[0], p[1], p[2]};
}

[[nodiscard]] inline Point point_of(const Eigen::Vector3d& v) {
  return {v[0], v[1], v[2]};
}

}  // namespace verisq
