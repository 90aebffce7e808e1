/// CGAL's orientation of meshes that bound a volume (GPL).
#include "host/surface/orientation.hpp"

#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/boost/graph/helpers.h>

#include <utility>
#include <verisq/mesh_topology.hpp>

#include "host/surface/cgal_mesh.hpp"

namespace verisq::surface {
namespace {

Point middle(const Mesh& mesh) {
  Point result{};
  const auto count = static_cast<double>(mesh.vertices.size());
  for (const Point& vertex : mesh.vertices)
    for (std::size_t axis = 0; axis < 3; ++axis) result[axis] += vertex[axis] / count;
  return result;
}

}  // namespace

Mesh oriented_outward(const Mesh& mesh) {
  CgalMesh oriented = halfedge_mesh(mesh);
  if (!CGAL::is_closed(oriented)) {
    Mesh open = indexed_mesh(oriented);
    return signed_volume(open, middle(open)) < 0.0 ? reversed(std::move(open)) : open;
  }
  CGAL::Polygon_mesh_processing::orient_to_bound_a_volume(oriented);
  return indexed_mesh(oriented);
}

Mesh reversed(Mesh mesh) {
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

}  // namespace verisq::surface
