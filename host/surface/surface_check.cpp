/// Self-intersections and distances by CGAL (GPL).
#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>

#include <algorithm>
#include <cmath>
#include <verisq/surface.hpp>

#include "host/surface/cgal_mesh.hpp"
#include "verify/containment/rims.hpp"

namespace verisq {
namespace {

using Tree =
    CGAL::AABB_tree<CGAL::AABB_traits<surface::Kernel, CGAL::AABB_face_graph_triangle_primitive<surface::CgalMesh>>>;

double farthest(const surface::CgalMesh& mesh, std::span<const Point> points) {
  Tree tree(faces(mesh).begin(), faces(mesh).end(), mesh);
  double largest = 0.0;
  for (const auto& [x, y, z] : points) largest = std::max(largest, tree.squared_distance({x, y, z}));
  return std::sqrt(largest);
}

}  // namespace

SurfaceCheck check_surface(const Mesh& surface, std::span<const Point> points) {
  const surface::CgalMesh mesh = surface::halfedge_mesh(surface);
  const MeshTopology topology = mesh_topology(surface);
  const bool has_rims = !topology.closed() && topology.manifold() && topology.oriented();
  return {.topology = topology,
          .volume = signed_volume(surface),
          .rims = has_rims ? verify::closing_over_rims(surface).rims : 0,
          .self_intersecting = CGAL::Polygon_mesh_processing::does_self_intersect(mesh),
          .farthest_point = farthest(mesh, points)};
}

}  // namespace verisq
