/// A mesh's triangles, and what is known of their vertices along a way.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "verisq/enclosure.hpp"
#include "verisq/mesh.hpp"

namespace verisq::verify {

/// Precondition: below the number of triangles.
[[nodiscard]] inline Triangle triangle_of(const Mesh& mesh, std::size_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  return {mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
}

/// Likewise, with an enclosure for each vertex.
[[nodiscard]] inline std::array<double, 3> lower_ends(const Mesh& mesh, std::size_t triangle,
                                                      std::span<const Enclosure> of_vertices) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  return {of_vertices[a].lo, of_vertices[b].lo, of_vertices[c].lo};
}

/// Vertices of no triangle are no part of the surface.
[[nodiscard]] inline double least_upper_end(const Mesh& mesh, std::span<const Enclosure> of_vertices) {
  double least = infinity;
  for (const auto& corners : mesh.triangles)
    for (const std::uint32_t vertex : corners) least = std::min(least, of_vertices[vertex].hi);
  return least;
}

}  // namespace verisq::verify
