/// CGAL's hole filling (GPL).
#include "host/surface/hole_filling.hpp"

#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>

#include <iterator>
#include <vector>

#include "host/surface/cgal_mesh.hpp"

namespace verisq::surface {
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

/// Whether that succeeded.
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

}  // namespace verisq::surface
