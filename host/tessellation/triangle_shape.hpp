/// Area, shape and turning of triangles that are about to change.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>

namespace verisq::tessellation {

using TriangleCorners = std::array<Eigen::Vector3d, 3>;

/// The normal, as long as twice the area.
[[nodiscard]] inline Eigen::Vector3d doubled_area(const TriangleCorners& triangle) {
  return (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
}

/// Twice the area over the square of the longest side: 0.87 where all are equal, 0 for a triangle of no area.
[[nodiscard]] inline double shape(const TriangleCorners& triangle) {
  double longest = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    longest = std::max(longest, (triangle[i] - triangle[(i + 1) % 3]).squaredNorm());
  }
  return longest > 0.0 ? doubled_area(triangle).norm() / longest : 0.0;
}

/// Between the normals.
[[nodiscard]] inline double cosine_between(const TriangleCorners& a, const TriangleCorners& b) {
  return doubled_area(a).stableNormalized().dot(doubled_area(b).stableNormalized());
}

}  // namespace verisq::tessellation
