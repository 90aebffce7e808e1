/// The alpha shape of a point cloud: a closed oriented surface through its points.
#pragma once

#include <optional>
#include <span>
#include <verisq/mesh.hpp>

namespace verisq::surface {

struct AlphaShape {
  Mesh mesh;     ///< normals outward, its vertices are those of the points that the surface goes through
  double alpha;  ///< the radius used
};

/// The outer boundary of the Delaunay tetrahedra of circumradius at most `alpha` (Edelsbrunner, Muecke:
/// Three-dimensional alpha shapes, 1994), of their largest component; made manifold by further tetrahedra where it is
/// not. Without `alpha`, which must be positive: the least of CGAL's optimum (one component, no point outside) times
/// 2^(k/4) whose boundary is manifold of itself and whose volume is that of a filled solid, not of a shell around the
/// points. Throws Error(input) where all points lie in one plane, and where no tetrahedron is as small as `alpha`.
[[nodiscard]] AlphaShape alpha_shape(std::span<const Point> points, std::optional<double> alpha);

}  // namespace verisq::surface
