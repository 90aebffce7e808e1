/// Makes damaged meshes closed, manifold and oriented.
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/boost/graph/helpers.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <unordered_map>
#include <utility>
#include <vector>
#include <verisq/mesh_topology.hpp>

#include "host/prepare/mesh_geometry.hpp"
#include "host/surface/surface_steps.hpp"
#include "verify/proof/closed_surface.hpp"

namespace verisq::surface {
namespace {

double area(const Point& a, const Point& b, const Point& c) {
  const Point u{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  const Point v{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  return std::hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]) / 2.0;
}

}  // namespace

LargestPart largest_part(const Mesh& mesh) {
  LargestPart result;
  if (mesh.triangles.empty()) return result;
  const std::vector<std::uint32_t> part = verify::connected_parts(mesh);
  std::unordered_map<std::uint32_t, double> areas;
  for (const auto& [a, b, c] : mesh.triangles)
    areas[part[a]] += area(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]);
  // Among equal ones the first vertex decides, not the order of the table.
  const auto largest = std::ranges::max_element(areas, [](const auto& one, const auto& other) {
    return one.second < other.second || (one.second == other.second && one.first > other.first);
  });
  constexpr auto none = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> index(mesh.vertices.size(), none);
  for (auto triangle : mesh.triangles) {
    if (part[triangle[0]] != largest->first) continue;
    for (std::uint32_t& vertex : triangle) {
      if (index[vertex] == none) {
        index[vertex] = static_cast<std::uint32_t>(result.mesh.vertices.size());
        result.mesh.vertices.push_back(mesh.vertices[vertex]);
      }
      vertex = index[vertex];
    }
    result.mesh.triangles.push_back(triangle);
  }
  result.parts_left_out = areas.size() - 1;
  return result;
}

namespace {

namespace processing = CGAL::Polygon_mesh_processing;
using Border = CgalMesh::Halfedge_index;

constexpr std::size_t most_edges_of_exhaustive_search = 300;

void fill(CgalMesh& mesh, Border border, bool delaunay) {
  std::vector<CgalMesh::Face_index> faces;
  std::vector<CgalMesh::Vertex_index> vertices;
  processing::triangulate_refine_and_fair_hole(mesh, border, std::back_inserter(faces), std::back_inserter(vertices),
                                               CGAL::parameters::use_delaunay_triangulation(delaunay));
}

/// Returns whether the hole was filled.
bool fill(CgalMesh& mesh, Border border) {
  const std::size_t edges = CGAL::halfedges_around_face(border, mesh).size();
  fill(mesh, border, true);
  if (mesh.is_border(border) && edges <= most_edges_of_exhaustive_search) fill(mesh, border, false);
  return !mesh.is_border(border);
}

}  // namespace

HoleFilling fill_holes(const Mesh& mesh) {
  CgalMesh filled = halfedge_mesh(mesh);
  processing::stitch_borders(filled);
  std::vector<Border> borders;
  processing::extract_boundary_cycles(filled, std::back_inserter(borders));
  HoleFilling result;
  result.holes = borders.size();
  for (const Border border : borders)
    if (fill(filled, border)) ++result.filled;
  result.mesh = indexed_mesh(filled);
  return result;
}

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
    return volume_sign(open, middle(open)) < 0 ? reversed(std::move(open)) : open;
  }
  CGAL::Polygon_mesh_processing::orient_to_bound_a_volume(oriented);
  return indexed_mesh(oriented);
}

Mesh reversed(Mesh mesh) {
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

Mesh remeshed(const Mesh& mesh, double edge) {
  constexpr unsigned rounds = 3;
  CgalMesh halfedges = halfedge_mesh(mesh);
  CGAL::Polygon_mesh_processing::isotropic_remeshing(faces(halfedges), edge, halfedges,
                                                     CGAL::parameters::number_of_iterations(rounds));
  return indexed_mesh(halfedges);
}

namespace {

// 1/forward + 1/back = 0.1, the pass-band frequency that Taubin recommends, section 3.
constexpr double forward = 0.5;
constexpr double back = -1.0 / (1.0 / forward - 0.1);

using Edge = std::pair<std::uint32_t, std::uint32_t>;

struct Edges {
  std::vector<Edge> all;        ///< once each
  std::vector<bool> on_border;  ///< for each vertex
};

Edges edges_of(const Mesh& mesh) {
  std::vector<Edge> sides;
  for (const auto& [a, b, c] : mesh.triangles)
    for (const Edge& side : {std::minmax({a, b}), std::minmax({b, c}), std::minmax({c, a})}) sides.push_back(side);
  std::ranges::sort(sides);
  Edges edges{.all = {}, .on_border = std::vector<bool>(mesh.vertices.size(), false)};
  for (auto first = sides.begin(); first != sides.end();) {
    const auto last = std::upper_bound(first, sides.end(), *first);
    edges.all.push_back(*first);
    if (last - first == 1) edges.on_border[first->first] = edges.on_border[first->second] = true;
    first = last;
  }
  return edges;
}

/// Moves each vertex by `factor` times the way to the mean of its neighbours.
void relax(Mesh& mesh, const Edges& edges, double factor) {
  std::vector<Point> ways(mesh.vertices.size(), Point{});
  std::vector<double> neighbours(mesh.vertices.size(), 0.0);
  for (const auto& [a, b] : edges.all) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double way = mesh.vertices[b][axis] - mesh.vertices[a][axis];
      ways[a][axis] += way;
      ways[b][axis] -= way;
    }
    neighbours[a] += 1.0;
    neighbours[b] += 1.0;
  }
  for (std::size_t k = 0; k < mesh.vertices.size(); ++k) {
    if (edges.on_border[k] || neighbours[k] == 0.0) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) mesh.vertices[k][axis] += factor / neighbours[k] * ways[k][axis];
  }
}

}  // namespace

Mesh smoothed(Mesh mesh, int rounds) {
  const Edges edges = edges_of(mesh);
  for (int round = 0; round < rounds; ++round) {
    relax(mesh, edges, forward);
    relax(mesh, edges, back);
  }
  return mesh;
}

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
