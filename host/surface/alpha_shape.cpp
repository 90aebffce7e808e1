/// CGAL's alpha shapes (GPL) and the choice of alpha.
#include "host/surface/alpha_shape.hpp"

#include <CGAL/Alpha_shape_3.h>
#include <CGAL/Alpha_shape_cell_base_3.h>
#include <CGAL/Alpha_shape_vertex_base_3.h>
#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <verisq/error.hpp>
#include <verisq/mesh_topology.hpp>

#include "host/surface/tetrahedra.hpp"

namespace verisq::surface {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Structure = CGAL::Triangulation_data_structure_3<CGAL::Alpha_shape_vertex_base_3<Kernel>,
                                                       CGAL::Alpha_shape_cell_base_3<Kernel>>;
using Shape = CGAL::Alpha_shape_3<CGAL::Delaunay_triangulation_3<Kernel, Structure>>;

Shape shape_of(std::span<const Point> points) {
  std::vector<Kernel::Point_3> cloud;
  cloud.reserve(points.size());
  for (const auto& [x, y, z] : points) cloud.emplace_back(x, y, z);
  CGAL::Delaunay_triangulation_3<Kernel, Structure> delaunay(cloud.begin(), cloud.end());
  if (delaunay.dimension() < 3)
    throw Error(ErrorKind::input, "the points lie in one plane: they have no alpha shape that is a solid");
  return Shape(delaunay, 0.0, Shape::REGULARIZED);
}

Tetrahedra tetrahedra_of(const Shape& shape) {
  Tetrahedra result;
  std::unordered_map<const void*, std::uint32_t> vertices;
  for (auto vertex = shape.finite_vertices_begin(); vertex != shape.finite_vertices_end(); ++vertex) {
    vertices[&*vertex] = static_cast<std::uint32_t>(result.points.size());
    result.points.push_back({vertex->point().x(), vertex->point().y(), vertex->point().z()});
  }
  std::unordered_map<const void*, std::uint32_t> cells;
  for (auto cell = shape.finite_cells_begin(); cell != shape.finite_cells_end(); ++cell)
    cells.emplace(&*cell, static_cast<std::uint32_t>(cells.size()));
  for (auto cell = shape.finite_cells_begin(); cell != shape.finite_cells_end(); ++cell) {
    std::array<std::uint32_t, 4> corners{};
    std::array<std::uint32_t, 4> neighbours{};
    for (std::size_t i = 0; i < 4; ++i) {
      corners[i] = vertices.at(&*cell->vertex(static_cast<int>(i)));
      const auto neighbour = cell->neighbor(static_cast<int>(i));
      neighbours[i] = shape.is_infinite(neighbour) ? no_neighbour : cells.at(&*neighbour);
    }
    result.corners.push_back(corners);
    result.neighbours.push_back(neighbours);
    result.circumradii.push_back(std::sqrt(cell->get_alpha()));  // CGAL's alpha is the square
  }
  return result;
}

/// At alphas below that of the solid, a sampled surface becomes a shell whose two sides are joined by holes. Its volume
/// is far below that of the next alphas, where the holes close.
bool is_solid(const Tetrahedra& tetrahedra, const Solid& solid, const Solid& next) {
  constexpr double plateau = 1.1;
  return volume(tetrahedra, next) <= plateau * volume(tetrahedra, solid) &&
         non_manifold_vertices(boundary(tetrahedra, solid)).empty();
}

double chosen_alpha(const Tetrahedra& tetrahedra, double optimum) {
  const double step = std::pow(2.0, 0.25);
  const double largest = *std::ranges::max_element(tetrahedra.circumradii);
  double alpha = optimum * (1.0 + 1e-12);  // the square root may have rounded it below the radius that it is
  Solid solid = alpha_solid(tetrahedra, alpha);
  while (alpha < largest) {
    Solid next = alpha_solid(tetrahedra, step * alpha);
    if (is_solid(tetrahedra, solid, next)) break;
    solid = std::move(next);
    alpha *= step;
  }
  return alpha;
}

Mesh without_unused_vertices(const Mesh& mesh) {
  Mesh result;
  std::unordered_map<std::uint32_t, std::uint32_t> indices;
  for (auto triangle : mesh.triangles) {
    for (std::uint32_t& vertex : triangle) {
      const auto [place, is_new] = indices.try_emplace(vertex, static_cast<std::uint32_t>(result.vertices.size()));
      if (is_new) result.vertices.push_back(mesh.vertices[vertex]);
      vertex = place->second;
    }
    result.triangles.push_back(triangle);
  }
  return result;
}

}  // namespace

AlphaShape alpha_shape(std::span<const Point> points, std::optional<double> alpha) {
  const Shape shape = shape_of(points);
  const Tetrahedra tetrahedra = tetrahedra_of(shape);
  if (!alpha) alpha = chosen_alpha(tetrahedra, std::sqrt(*shape.find_optimal_alpha(1)));
  const Solid solid = with_manifold_boundary(tetrahedra, alpha_solid(tetrahedra, *alpha));
  Mesh mesh = without_unused_vertices(boundary(tetrahedra, solid));
  if (mesh.triangles.empty())
    throw Error(ErrorKind::input, fmt::format("alpha = {}: no tetrahedron of the points is as small as that", *alpha));
  return {std::move(mesh), *alpha};
}

}  // namespace verisq::surface
