/// A Delaunay tetrahedralisation as arrays, and the solid that some of its tetrahedra make.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>
#include <verisq/mesh.hpp>

namespace verisq::surface {

/// Instead of a neighbour: the facet lies on the convex hull.
inline constexpr std::uint32_t no_neighbour = std::numeric_limits<std::uint32_t>::max();

/// The tetrahedra fill the convex hull of the points; all vectors but `points` have one entry a tetrahedron.
struct Tetrahedra {
  std::vector<Point> points;
  std::vector<std::array<std::uint32_t, 4>> corners;     ///< positively oriented
  std::vector<std::array<std::uint32_t, 4>> neighbours;  ///< opposite to each corner
  std::vector<double> circumradii;
};

/// Whether each tetrahedron belongs to the solid.
using Solid = std::vector<bool>;

/// The tetrahedra of circumradius at most `alpha`, and the voids that they enclose; of several components (connected
/// through facets) the one of the largest volume.
[[nodiscard]] Solid alpha_solid(const Tetrahedra& tetrahedra, double alpha);

[[nodiscard]] double volume(const Tetrahedra& tetrahedra, const Solid& solid);

/// The facets between the solid and the rest, normals outward: closed and oriented, not always manifold. The vertices
/// are all points.
[[nodiscard]] Mesh boundary(const Tetrahedra& tetrahedra, const Solid& solid);

/// Adds tetrahedra, the smallest circumradii first, where the boundary is no manifold, until it is one. That ends: the
/// convex hull is a manifold.
[[nodiscard]] Solid with_manifold_boundary(const Tetrahedra& tetrahedra, Solid solid);

}  // namespace verisq::surface
