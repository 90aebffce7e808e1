/// Whether a mesh bounds a solid: closed, manifold, consistently oriented; and its Euler characteristic and volume.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>
#include <verisq/mesh.hpp>

namespace verisq {

/// Counts alone: what the indices say, not where the vertices lie. Vertices that no triangle uses are left out.
struct MeshTopology {
  std::size_t vertices = 0;
  std::size_t edges = 0;
  std::size_t triangles = 0;
  std::size_t components = 0;             ///< sets of triangles that are connected through edges
  std::size_t boundary_edges = 0;         ///< of one triangle
  std::size_t non_manifold_edges = 0;     ///< of more than two triangles
  std::size_t non_manifold_vertices = 0;  ///< see the function of that name
  std::size_t inconsistent_edges = 0;     ///< of two triangles that run through it the same way

  [[nodiscard]] bool closed() const { return triangles > 0 && boundary_edges == 0; }
  [[nodiscard]] bool manifold() const { return non_manifold_edges == 0 && non_manifold_vertices == 0; }
  [[nodiscard]] bool oriented() const { return inconsistent_edges == 0; }
  [[nodiscard]] bool bounds_solid() const { return closed() && manifold() && oriented(); }

  /// V - E + F.
  [[nodiscard]] std::int64_t euler_characteristic() const;

  /// The sum over all components (0 for spheres, 1 for a torus); nothing unless `bounds_solid()`.
  [[nodiscard]] std::optional<std::int64_t> genus() const;
};

/// Precondition: the corners of each triangle differ, as in every mesh that a reader delivers.
[[nodiscard]] MeshTopology mesh_topology(const Mesh& mesh);

/// Vertices whose triangles are not one fan, in ascending order: bow ties, and the ends of non-manifold edges. Same
/// precondition.
[[nodiscard]] std::vector<std::uint32_t> non_manifold_vertices(const Mesh& mesh);

/// Positive where the normals of a closed mesh point outward; rounded to nearest, no enclosure. Of no meaning unless
/// the mesh is closed and oriented.
[[nodiscard]] double signed_volume(const Mesh& mesh);

/// The same as the sum of the cones from `apex` to the triangles: for open meshes, which bound nothing.
[[nodiscard]] double signed_volume(const Mesh& mesh, const Point& apex);

}  // namespace verisq
