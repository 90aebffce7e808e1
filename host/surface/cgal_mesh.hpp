/// Meshes in the types of CGAL: what the steps of the surface preparation share.
#pragma once

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>

#include <array>
#include <span>
#include <vector>
#include <verisq/mesh.hpp>

namespace verisq::surface {

/// Predicates are exact, so that no decision is lost to rounding; new points are rounded.
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalMesh = CGAL::Surface_mesh<Kernel::Point_3>;

/// A soup: triangles need not fit together.
struct TriangleSoup {
  std::vector<Kernel::Point_3> points;
  std::vector<std::array<std::size_t, 3>> triangles;
};

[[nodiscard]] std::vector<Kernel::Point_3> cgal_points(std::span<const Point> points);
[[nodiscard]] TriangleSoup triangle_soup(const Mesh& mesh);

/// The mesh with neighbouring triangles turned alike. A halfedge structure knows manifolds only: where the mesh is
/// none, or cannot be oriented, vertices are duplicated and the mesh is open there.
[[nodiscard]] CgalMesh halfedge_mesh(const Mesh& mesh);

/// In the order of CGAL's indices, without vertices of no triangle.
[[nodiscard]] Mesh indexed_mesh(const CgalMesh& mesh);

}  // namespace verisq::surface
