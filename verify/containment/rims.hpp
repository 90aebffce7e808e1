/// The rims of an open mesh, and the triangles that close it over them (docs/mathematics.md §22).
#pragma once

#include <cstddef>
#include <vector>
#include <verisq/mesh.hpp>

namespace verisq::verify {

struct Closing {
  Mesh mesh;              ///< a fan over each rim, about the mean of its vertices; no triangle where the mesh is closed
  std::size_t rims = 0;   ///< closed walks along open edges
  std::size_t edges = 0;  ///< open ones
};

/// With the triangles of the mesh, those of the closing run through every edge as often one way as the other.
/// Preconditions: the corners of each triangle differ; no edge has more than two triangles, or two that run through it
/// the same way.
[[nodiscard]] Closing closing_over_rims(const Mesh& mesh);

/// The triangles of both: a closed surface.
[[nodiscard]] std::vector<Triangle> closed_triangles(const Mesh& mesh, const Closing& closing);

}  // namespace verisq::verify
