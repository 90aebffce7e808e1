/// Steps from points, labels and damaged meshes to closed surfaces: alpha shapes, level sets, repair.
#pragma once

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq::surface {

// Surfaces of clouds by alpha shapes, and of labels by level sets.

// Closed surfaces of points and triangles by balls of radius alpha: alpha shapes and alpha wraps.

// A Delaunay tetrahedralisation as arrays, and the solid that some of its tetrahedra make.

/// Instead of a neighbour: the facet lies on the convex hull.
inline constexpr std::uint32_t no_neighbour = std::numeric_limits<std::uint32_t>::max();

/// The tetrahedra fill the convex hull of the points; all vectors but `points` have one entry a tetrahedron.
struct Tetrahedra {
  std::vector<Point> points;
  std::vector<std::array<std::uint32_t, 4>> corners;     ///< positively oriented
  std::vector<std::array<std::uint32_t, 4>> neighbours;  ///< opposite to each corner
  std::vector<double> circumradii;
};

/// A flag for each tetrahedron: it belongs to the solid.
using Solid = std::vector<bool>;

[[nodiscard]] double volume(const Tetrahedra& tetrahedra, const Solid& solid);

/// The facets between the solid and the rest, normals outward: closed and oriented, not always manifold. The vertices
/// are all points.
[[nodiscard]] Mesh boundary(const Tetrahedra& tetrahedra, const Solid& solid);

/// Adds tetrahedra, the smallest circumradii first, where the boundary is no manifold, until it is one. This
/// terminates: the convex hull is a manifold.
[[nodiscard]] Solid with_manifold_boundary(const Tetrahedra& tetrahedra, Solid solid);

// The alpha shape of a point cloud: a closed oriented surface through its points.

struct AlphaShape {
  Mesh mesh;     ///< normals outward; its vertices are the points through which the surface goes
  double alpha;  ///< the radius used
};

/// The outer boundary of the largest component of the Delaunay tetrahedra of circumradius at most `alpha`
/// (Edelsbrunner, Muecke: Three-dimensional alpha shapes, 1994). Further tetrahedra make it manifold if it is not.
/// `alpha` must be positive. Without it: the least of CGAL's optimum (one component, no point outside) times 2^(k/4)
/// whose boundary is manifold of itself and whose volume is that of a filled solid, not of a shell around the points.
/// Throws Error(input) if all points lie in one plane, and if no tetrahedron is as small as `alpha`.
[[nodiscard]] AlphaShape alpha_shape(std::span<const Point> points, std::optional<double> alpha);

// The choice of the alpha of a wrap: as small as the gaps of the input allow.

struct Wrap {
  Mesh mesh;
  double alpha;
  double offset;
};

/// The wrap with the alpha that `prepare_surface` promises; `offset` as given, or alpha / 100. Throws Error(input)
/// where all vertices coincide.
[[nodiscard]] Wrap wrap_with_chosen_alpha(const Mesh& input, std::optional<double> offset);

/// The wrap with the alpha given.
[[nodiscard]] Wrap wrap(const Mesh& input, double alpha, std::optional<double> offset);

// Functions sampled on a lattice, the surfaces where they are zero, and those of labelled volumes.

// A function sampled at the points of a lattice.

/// Point (i, j, k) is origin + i steps[0] + j steps[1] + k steps[2], its value the one at `index(i, j, k)`. Steps are
/// linearly independent.
struct GridSamples {
  std::array<std::size_t, 3> counts;
  Point origin;
  std::array<Point, 3> steps;
  std::vector<float> values;

  [[nodiscard]] std::size_t index(std::size_t i, std::size_t j, std::size_t k) const {
    return i + counts[0] * (j + counts[1] * k);
  }
  [[nodiscard]] Point point(std::size_t i, std::size_t j, std::size_t k) const {
    Point x = origin;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      x[axis] += static_cast<double>(i) * steps[0][axis] + static_cast<double>(j) * steps[1][axis] +
                 static_cast<double>(k) * steps[2][axis];
    }
    return x;
  }
};

// The surface on which a sampled function is zero.

/// Marching tetrahedra: every cell of the lattice is cut into Kuhn's six tetrahedra, in which the function is linear.
/// No vertex comes nearer to a sample than a fiftieth of its edge. The result is the boundary of the region where the
/// function is positive: closed, manifold and outward. Preconditions: the outermost samples are not positive; less than
/// 2^32 vertices.
[[nodiscard]] Mesh level_surface(const GridSamples& samples);

// Meshes in CGAL's form, and damaged meshes made closed and oriented.

// Repairs of meshes: largest parts, filled holes, orientation, edges of equal length, smoothing.

// The largest part of a surface in several parts.

struct LargestPart {
  Mesh mesh;  ///< without unused vertices
  std::size_t parts_left_out = 0;
};

/// The largest by area; parts are connected through vertices. No triangles for a mesh that has none.
[[nodiscard]] LargestPart largest_part(const Mesh& mesh);

// Closes the holes of a given mesh.

struct HoleFilling {
  Mesh mesh;
  std::size_t holes = 0;   ///< number of holes
  std::size_t filled = 0;  ///< number of filled holes
};

/// Joins borders along equal vertices, then triangulates each hole, refines its triangles to the density around it and
/// fairs them (Liepa: Filling holes in meshes, 2003). If Delaunay triangles cannot fill a hole, the best of all
/// triangulations does, for at most 300 edges, because that takes cubic time. Where three triangles meet at an edge,
/// vertices are duplicated first.
[[nodiscard]] HoleFilling fill_holes(const Mesh& mesh);

// Turns the triangles of a mesh so that their normals point to one side.

/// Normals point away from the solid that the mesh bounds; normals of cavities inside it point into the cavities. For
/// an open mesh they point such that its volume about its middle is positive. Where the mesh is no manifold, vertices
/// are duplicated.
[[nodiscard]] Mesh oriented_outward(const Mesh& mesh);

/// Every triangle turned.
[[nodiscard]] Mesh reversed(Mesh mesh);

// Triangles of about equal sides.

/// Splits, collapses and flips edges and relaxes vertices, which are then put back onto the surface, three times
/// (Botsch, Kobbelt: A remeshing approach to multiresolution modeling, 2004). Borders stay in place. Preconditions:
/// manifold, edge > 0.
[[nodiscard]] Mesh remeshed(const Mesh& mesh, double edge);

// Smooths a mesh without shrinking it.

/// Taubin's smoothing (A signal processing approach to fair surface design, SIGGRAPH 1995). Each round moves every
/// vertex towards the mean of its neighbours, then all a little farther back. This damps ripples of a few edges and
/// keeps the shape. Vertices at the border of an open mesh stay. Precondition: rounds >= 0.
[[nodiscard]] Mesh smoothed(Mesh mesh, int rounds);

// Meshes in the types of CGAL: the shared parts of the steps of the surface preparation.

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

/// The mesh with neighbouring triangles oriented alike. A halfedge structure can only represent manifolds: where the
/// mesh is none, or cannot be oriented, vertices are duplicated and the mesh is open there.
[[nodiscard]] CgalMesh halfedge_mesh(const Mesh& mesh);

/// In the order of CGAL's indices, without unused vertices.
[[nodiscard]] Mesh indexed_mesh(const CgalMesh& mesh);

}  // namespace verisq::surface
