/// Marching tetrahedra: a solid's surface in a grid of them, one vertex on each edge that leaves the solid.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "host/tessellation/bisected_tetrahedra.hpp"
#include "host/tessellation/solid.hpp"

namespace verisq::tessellation {

/// Vertices lie inside edges, triangles inside tetrahedra that meet face to face: where the grid's boundary is outside
/// the solid, the triangles bound a solid, closed, manifold and without intersections.
struct TetrahedraSurface {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::size_t> primitives;                  ///< of each vertex: on whose surface it lies
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< outward
  std::vector<std::uint32_t> tetrahedra;                ///< of each triangle
};

/// Remembers what it evaluated, for the next time when the grid is finer.
class SurfaceMarcher {
 public:
  /// Both must outlive it.
  SurfaceMarcher(const Solid& solid, const BisectedTetrahedra& grid) : solid_(solid), grid_(grid) {}

  [[nodiscard]] TetrahedraSurface surface();

  /// Whether the solid contains a vertex of the grid. After `surface`, or `classify`.
  [[nodiscard]] bool inside(std::uint32_t vertex) const { return inside_[vertex] != 0; }
  void classify();

 private:
  struct Crossing {
    Eigen::Vector3d point;
    std::size_t primitive;
  };

  void add_triangles(std::uint32_t k, TetrahedraSurface& surface);
  std::uint32_t vertex_on(std::uint32_t a, std::uint32_t b, TetrahedraSurface& surface);
  [[nodiscard]] Crossing crossing(std::uint32_t inside, std::uint32_t outside) const;

  const Solid& solid_;
  const BisectedTetrahedra& grid_;
  std::vector<std::uint8_t> inside_;
  std::unordered_map<std::uint64_t, Crossing> crossings_;
  std::unordered_map<std::uint64_t, std::uint32_t> indices_;  // of the surface in the making
};

}  // namespace verisq::tessellation
