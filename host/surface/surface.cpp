/// Closed surfaces of clouds, by alpha shapes, and of damaged meshes.
#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Alpha_shape_3.h>
#include <CGAL/Alpha_shape_cell_base_3.h>
#include <CGAL/Alpha_shape_vertex_base_3.h>
#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/alpha_wrap_3.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <unordered_map>
#include <utility>
#include <verisq/error.hpp>
#include <verisq/mesh_topology.hpp>
#include <verisq/surface.hpp>

#include "host/prepare/mesh_geometry.hpp"
#include "host/surface/surface_steps.hpp"
#include "verify/proof/closed_surface.hpp"

namespace verisq {
namespace {

void begin(const SurfaceOptions& options, std::string_view step) {
  if (options.progress) options.progress(step);
}

PreparedSurface wrapped(const Mesh& input, const SurfaceOptions& options) {
  begin(options, "wrapping");
  surface::Wrap wrap = options.alpha ? surface::wrap(input, *options.alpha, options.offset)
                                     : surface::wrap_with_chosen_alpha(input, options.offset);
  return {.mesh = std::move(wrap.mesh), .alpha = wrap.alpha, .offset = wrap.offset};
}

PreparedSurface shaped(const Mesh& input, const SurfaceOptions& options) {
  begin(options, "alpha shape");
  surface::AlphaShape shape = surface::alpha_shape(input.vertices, options.alpha);
  return {.mesh = std::move(shape.mesh), .alpha = shape.alpha, .offset = std::nullopt};
}

PreparedSurface mended(const Mesh& input, const SurfaceOptions& options) {
  if (input.triangles.empty())
    throw Error(ErrorKind::input, "the mesh has no triangles: its points need a method, wrap or alpha");
  PreparedSurface result;
  if (options.fill_holes) {
    begin(options, "filling holes");
    surface::HoleFilling filling = surface::fill_holes(input);
    result.holes = filling.holes;
    result.holes_filled = filling.filled;
    result.mesh = std::move(filling.mesh);
  }
  begin(options, "orienting");
  result.mesh = surface::oriented_outward(options.fill_holes ? result.mesh : input);
  return result;
}

PreparedSurface made(const Mesh& input, const SurfaceOptions& options) {
  switch (options.method) {
    case SurfaceMethod::given: return mended(input, options);
    case SurfaceMethod::wrap: return wrapped(input, options);
    case SurfaceMethod::alpha_shape: break;
  }
  return shaped(input, options);
}

/// The cut leaves slivers, which remeshing mends.
void open(PreparedSurface& surface, const Plane& plane, const SurfaceOptions& options) {
  begin(options, "opening");
  surface::LargestPart part = surface::largest_part(cut_off(surface.mesh, plane).mesh);
  if (part.mesh.triangles.empty())
    throw Error(ErrorKind::input, "all of the surface lies beyond the plane where it is to be opened");
  surface.mesh = options.edge ? surface::remeshed(part.mesh, *options.edge) : std::move(part.mesh);
  surface.parts_left_out = part.parts_left_out;
}

}  // namespace

PreparedSurface prepare_surface(const Mesh& input, const SurfaceOptions& options) {
  PreparedSurface result = made(input, options);
  if (options.edge) {
    begin(options, "remeshing");
    result.mesh = surface::remeshed(result.mesh, *options.edge);
  }
  result.volume_before_smoothing = result.volume = signed_volume(result.mesh);
  if (options.smoothing_rounds > 0) {
    begin(options, "smoothing");
    result.mesh = surface::smoothed(std::move(result.mesh), options.smoothing_rounds);
    result.volume = signed_volume(result.mesh);
  }
  if (options.opening) open(result, *options.opening, options);
  if (options.facing == Facing::inward) result.mesh = surface::reversed(std::move(result.mesh));
  return result;
}

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

namespace verisq::surface {
namespace {

/// The corners of the facet opposite to each corner, counter-clockwise seen from outside.
constexpr std::array<std::array<std::size_t, 3>, 4> facets{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

double volume(const Tetrahedra& tetrahedra, std::size_t k) {
  const auto& corners = tetrahedra.corners[k];
  const Point& apex = tetrahedra.points[corners[0]];
  std::array<Point, 3> sides{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis) sides[i][axis] = tetrahedra.points[corners[i + 1]][axis] - apex[axis];
  const auto& [a, b, c] = sides;
  return (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
          a[2] * (b[0] * c[1] - b[1] * c[0])) /
         6.0;
}

/// All tetrahedra that paths through facets reach from `start` without leaving those of `solid`; if `start` is not in
/// `solid`, without entering them. Marks them in `reached`.
std::vector<std::uint32_t> flood(const Tetrahedra& tetrahedra, const Solid& solid, std::uint32_t start,
                                 Solid& reached) {
  std::vector<std::uint32_t> found{start};
  reached[start] = true;
  for (std::size_t next = 0; next < found.size(); ++next) {
    for (const std::uint32_t neighbour : tetrahedra.neighbours[found[next]]) {
      if (neighbour == no_neighbour || reached[neighbour] || solid[neighbour] != solid[start]) continue;
      reached[neighbour] = true;
      found.push_back(neighbour);
    }
  }
  return found;
}

bool on_hull(const Tetrahedra& tetrahedra, std::size_t k) {
  return std::ranges::find(tetrahedra.neighbours[k], no_neighbour) != tetrahedra.neighbours[k].end();
}

/// The solid and all that cannot be reached from outside the hull.
Solid with_voids_filled(const Tetrahedra& tetrahedra, const Solid& solid) {
  Solid reached(solid.size(), false);
  for (std::uint32_t k = 0; k < solid.size(); ++k)
    if (!solid[k] && !reached[k] && on_hull(tetrahedra, k)) (void)flood(tetrahedra, solid, k, reached);
  reached.flip();
  return reached;
}

Solid largest_component(const Tetrahedra& tetrahedra, const Solid& solid) {
  std::vector<std::uint32_t> largest;
  double largest_volume = -1.0;
  Solid reached(solid.size(), false);
  for (std::uint32_t k = 0; k < solid.size(); ++k) {
    if (!solid[k] || reached[k]) continue;
    std::vector<std::uint32_t> component = flood(tetrahedra, solid, k, reached);
    double sum = 0.0;
    for (const std::uint32_t member : component) sum += volume(tetrahedra, member);
    if (sum <= largest_volume) continue;
    largest_volume = sum;
    largest = std::move(component);
  }
  Solid result(solid.size(), false);
  for (const std::uint32_t member : largest) result[member] = true;
  return result;
}

/// For each of `vertices`: the tetrahedron of the smallest circumradius that is not in the solid.
std::vector<std::uint32_t> smallest_outside(const Tetrahedra& tetrahedra, const Solid& solid,
                                            const std::vector<std::uint32_t>& vertices) {
  std::map<std::uint32_t, std::optional<std::uint32_t>> smallest;
  for (const std::uint32_t vertex : vertices) smallest[vertex];
  for (std::uint32_t k = 0; k < solid.size(); ++k) {
    if (solid[k]) continue;
    for (const std::uint32_t corner : tetrahedra.corners[k]) {
      const auto place = smallest.find(corner);
      if (place == smallest.end()) continue;
      if (!place->second || tetrahedra.circumradii[k] < tetrahedra.circumradii[*place->second]) place->second = k;
    }
  }
  std::vector<std::uint32_t> result;
  for (const auto& entry : smallest)
    if (entry.second) result.push_back(*entry.second);
  return result;
}

/// The tetrahedra of circumradius at most `alpha`, and the voids that they enclose; if there are several components
/// (connected through facets), only the one of the largest volume.
Solid alpha_solid(const Tetrahedra& tetrahedra, double alpha) {
  Solid solid(tetrahedra.corners.size());
  for (std::size_t k = 0; k < solid.size(); ++k) solid[k] = tetrahedra.circumradii[k] <= alpha;
  return largest_component(tetrahedra, with_voids_filled(tetrahedra, solid));
}

}  // namespace

double volume(const Tetrahedra& tetrahedra, const Solid& solid) {
  double sum = 0.0;
  for (std::size_t k = 0; k < solid.size(); ++k)
    if (solid[k]) sum += volume(tetrahedra, k);
  return sum;
}

Mesh boundary(const Tetrahedra& tetrahedra, const Solid& solid) {
  Mesh mesh{.vertices = tetrahedra.points, .triangles = {}};
  for (std::size_t k = 0; k < solid.size(); ++k) {
    if (!solid[k]) continue;
    for (std::size_t i = 0; i < 4; ++i) {
      const std::uint32_t neighbour = tetrahedra.neighbours[k][i];
      if (neighbour != no_neighbour && solid[neighbour]) continue;
      const auto& corners = tetrahedra.corners[k];
      mesh.triangles.push_back({corners[facets[i][0]], corners[facets[i][1]], corners[facets[i][2]]});
    }
  }
  return mesh;
}

Solid with_manifold_boundary(const Tetrahedra& tetrahedra, Solid solid) {
  for (;;) {
    const std::vector<std::uint32_t> vertices = non_manifold_vertices(boundary(tetrahedra, solid));
    if (vertices.empty()) return solid;
    const std::vector<std::uint32_t> additions = smallest_outside(tetrahedra, solid, vertices);
    for (const std::uint32_t addition : additions) solid[addition] = true;
    solid = with_voids_filled(tetrahedra, solid);
  }
}

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
/// is far below that at the next alphas, where the holes close.
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

namespace {

/// Contains all of `input`: its triangles or, if it has none, its points. Balls of radius `alpha` carve the space
/// outside away; they stop at the distance `offset` (Portaneri, Rouxel-Labbé, Hemmer, Cohen-Steiner, Alliez: Alpha
/// Wrapping with an Offset, SIGGRAPH 2022). Gaps narrower than 2 alpha are bridged. Normals point outward.
/// Preconditions: alpha, offset > 0; `input` is not empty.
Mesh alpha_wrap(const Mesh& input, double alpha, double offset) {
  CgalMesh wrap;
  if (input.triangles.empty()) {
    CGAL::alpha_wrap_3(cgal_points(input.vertices), alpha, offset, wrap);
  } else {
    const TriangleSoup soup = triangle_soup(input);
    CGAL::alpha_wrap_3(soup.points, soup.triangles, alpha, offset, wrap);
  }
  return indexed_mesh(wrap);
}

constexpr double coarsest = 20.0;  ///< diagonal / alpha: bridges the gaps of any cloud worth the name
constexpr int most_refinements = 4;
constexpr double offset_ratio = 100.0;  ///< alpha / offset

/// Balls that enter through a gap carve out the inside: the rest is a shell around the input.
bool breaks_through(const Mesh& finer, const Mesh& coarser) {
  constexpr double least_volume_kept = 0.85;
  const MeshTopology fine = mesh_topology(finer);
  const MeshTopology coarse = mesh_topology(coarser);
  return signed_volume(finer) < least_volume_kept * signed_volume(coarser) || fine.components > coarse.components ||
         fine.genus() > coarse.genus();
}

}  // namespace

Wrap wrap(const Mesh& input, double alpha, std::optional<double> offset) {
  const double kept = offset.value_or(alpha / offset_ratio);
  return {alpha_wrap(input, alpha, kept), alpha, kept};
}

Wrap wrap_with_chosen_alpha(const Mesh& input, std::optional<double> offset) {
  const double diagonal = 2.0 * extent_of(input.vertices).half_diagonal();
  if (!(diagonal > 0.0)) throw Error(ErrorKind::input, "all points coincide: there is nothing to wrap");
  Wrap best = wrap(input, diagonal / coarsest, offset);
  for (int k = 0; k < most_refinements; ++k) {
    Wrap finer = wrap(input, best.alpha / std::sqrt(2.0), offset);
    if (breaks_through(finer.mesh, best.mesh)) break;
    best = std::move(finer);
  }
  return best;
}

}  // namespace verisq::surface
