/// Extents of points, the handedness of axes, signs of volumes; topology and cuts of meshes.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq {

// The box around points.

/// Everything is finite for finite points, also where sizes would overflow.
struct Extent {
  Point lower{};
  Point upper{};

  [[nodiscard]] Point centre() const {
    return {lower[0] / 2.0 + upper[0] / 2.0, lower[1] / 2.0 + upper[1] / 2.0, lower[2] / 2.0 + upper[2] / 2.0};
  }
  /// Half of the longest side.
  [[nodiscard]] double half_size() const {
    double half = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) half = std::max(half, upper[axis] / 2.0 - lower[axis] / 2.0);
    return half;
  }
  [[nodiscard]] double half_diagonal() const {
    return std::hypot(upper[0] / 2.0 - lower[0] / 2.0, upper[1] / 2.0 - lower[1] / 2.0,
                      upper[2] / 2.0 - lower[2] / 2.0);
  }
};

/// The extent of no points lies at the origin.
[[nodiscard]] inline Extent extent_of(std::span<const Point> points) {
  if (points.empty()) return {};
  Extent extent{points.front(), points.front()};
  for (const Point& point : points) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      extent.lower[axis] = std::min(extent.lower[axis], point[axis]);
      extent.upper[axis] = std::max(extent.upper[axis], point[axis]);
    }
  }
  return extent;
}

// For three axes: the volume of the box that they span, and their handedness.

/// a·(b × c), to nearest: negative if they are left-handed.
[[nodiscard]] inline double determinant(const std::array<Point, 3>& axes) {
  const auto& [a, b, c] = axes;
  return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

// Two meshes as one.

/// Appends the vertices and triangles of another mesh.
inline void append(Mesh& mesh, const Mesh& other) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({a + first, b + first, c + first});
}

// The sign of the volume of a mesh, at every size.

/// The sign of `signed_volume`, 1, -1 or 0, also if the volume underflows or overflows.
[[nodiscard]] int volume_sign(const Mesh& mesh);
[[nodiscard]] int volume_sign(const Mesh& mesh, const Point& apex);

}  // namespace verisq
