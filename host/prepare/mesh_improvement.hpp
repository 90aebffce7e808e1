/// Triangles of a solid's surface that move onto creases or are thinned out: their shapes and deviations.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "host/prepare/solid.hpp"
#include "host/prepare/tetrahedra_surface.hpp"

namespace verisq::tessellation {

// Area, shape and turning of triangles that are about to change.

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

// The distances of triangles from a solid's surface, at points of them: an estimate, which proves nothing.

/// The sampled points of a triangle: weights in steps of 1/`steps`, without the corners.
enum class Sampling : int { coarse = 2, usual = 3, fine = 6 };

/// The number of these points.
[[nodiscard]] constexpr std::size_t samples_of(Sampling sampling) {
  const auto steps = static_cast<std::size_t>(sampling);
  return (steps + 1) * (steps + 2) / 2 - 3 + (steps % 3 == 0 ? 0 : 1);
}

/// Returns whether the sampled points of the triangle are found to be at most `deviation` away from the surface.
[[nodiscard]] bool within(const Solid& solid, const TriangleCorners& triangle, double deviation, Sampling sampling);

/// The least of a sequence of bounds that `within` finds to hold, at most `most`. The sequence starts at `least`, and
/// each bound is 1/8 above the one before.
[[nodiscard]] double sampled_deviation(const Solid& solid, const TriangleCorners& triangle, double least, double most,
                                       Sampling sampling);

// Moves vertices of a surface onto the creases where two primitives meet, so that no edge runs across.

/// For each edge between vertices of two primitives, moves the vertex nearer to the crease onto it, if no triangle then
/// turns over or loses its area. Returns for each vertex whether it was moved; once interrupted, no more are moved.
std::vector<bool> snap_to_creases(const Solid& solid, TetrahedraSurface& surface,
                                  const std::function<bool()>& interrupted);

// Takes vertices out of a surface that bounds a solid, where it stays as near to the solid's surface without them.

struct Triangles {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Collapses edges onto one of their ends, short ones first. The topology must stay (link condition: Dey, Edelsbrunner
/// et al., Topology preserving edge contraction, 1999), and no triangle may turn over. Every removed vertex must be
/// within `deviation` of the triangles that replace it, and these, at sampled points, of the solid. Stops early, with a
/// valid surface, once `interrupted` returns true.
[[nodiscard]] Triangles collapse_edges(const Solid& solid, Triangles surface, double deviation,
                                       const std::function<bool()>& interrupted);

}  // namespace verisq::tessellation
