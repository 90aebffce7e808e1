/// Copies of vertices and triangles.
#include "host/surface/cgal_mesh.hpp"

#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>

#include <cstdint>

namespace verisq::surface {

std::vector<Kernel::Point_3> cgal_points(std::span<const Point> points) {
  std::vector<Kernel::Point_3> result;
  result.reserve(points.size());
  for (const auto& [x, y, z] : points) result.emplace_back(x, y, z);
  return result;
}

TriangleSoup triangle_soup(const Mesh& mesh) {
  TriangleSoup soup{.points = cgal_points(mesh.vertices), .triangles = {}};
  soup.triangles.reserve(mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) soup.triangles.push_back({a, b, c});
  return soup;
}

CgalMesh halfedge_mesh(const Mesh& mesh) {
  TriangleSoup soup = triangle_soup(mesh);
  CGAL::Polygon_mesh_processing::orient_polygon_soup(soup.points, soup.triangles);
  CgalMesh result;
  CGAL::Polygon_mesh_processing::polygon_soup_to_polygon_mesh(soup.points, soup.triangles, result);
  return result;
}

Mesh indexed_mesh(const CgalMesh& mesh) {
  std::vector<std::uint32_t> index(mesh.num_vertices() + mesh.number_of_removed_vertices());
  Mesh result;
  for (const auto vertex : mesh.vertices()) {
    if (mesh.is_isolated(vertex)) continue;
    index[vertex.idx()] = static_cast<std::uint32_t>(result.vertices.size());
    const auto& point = mesh.point(vertex);
    result.vertices.push_back({point.x(), point.y(), point.z()});
  }
  for (const auto face : mesh.faces()) {
    std::array<std::uint32_t, 3> triangle{};
    std::size_t corner = 0;
    for (const auto vertex : CGAL::vertices_around_face(mesh.halfedge(face), mesh))
      triangle[corner++] = index[vertex.idx()];
    result.triangles.push_back(triangle);
  }
  return result;
}

}  // namespace verisq::surface
