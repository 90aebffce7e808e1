/// Closes the holes of a given mesh.
#pragma once

#include <cstddef>
#include <verisq/mesh.hpp>

namespace verisq::surface {

struct HoleFilling {
  Mesh mesh;
  std::size_t holes = 0;   ///< there were
  std::size_t filled = 0;  ///< of them
};

/// Joins borders along equal vertices, then triangulates each hole, refines its triangles to the density around it and
/// fairs them (Liepa: Filling holes in meshes, 2003). A hole that Delaunay triangles cannot fill is filled by the best
/// of all triangulations where it has at most 300 edges, for that takes cubic time. Where three triangles meet at an
/// edge, vertices are duplicated first.
[[nodiscard]] HoleFilling fill_holes(const Mesh& mesh);

}  // namespace verisq::surface
