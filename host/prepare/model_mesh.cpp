/// Meshes of models, through surfaces in tetrahedra.
#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <span>
#include <utility>
#include <verisq/distance.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/error.hpp>
#include <verisq/mesh_topology.hpp>

#include "host/prepare/eigen_points.hpp"
#include "host/prepare/mesh_geometry.hpp"
#include "host/prepare/solid.hpp"
#include "host/prepare/tetrahedra_surface.hpp"
#include "host/threads/parallel.hpp"
#include "verify/search/closed_mesh.hpp"
#include "verify/search/solid_pair_distance.hpp"
#include "verify/solids/model.hpp"

namespace verisq {
namespace tessellation {
namespace {

/// Share of the deviation that samples may show, so that the deviation between them stays below the whole.
constexpr double share_of_samples = 0.5;
/// Share of the deviation: tetrahedra below this size are not refined any more.
constexpr double smallest_tetrahedron = 0.25;
/// Share of the deviation: the largest last bit of a coordinate.
constexpr double largest_rounding = 1e-3;
constexpr std::size_t triangles_a_chunk = 512;

Mesh mesh_of(const Triangles& triangles) {
  Mesh mesh;
  for (const Eigen::Vector3d& vertex : triangles.vertices) mesh.vertices.push_back(point_of(vertex));
  mesh.triangles = triangles.triangles;
  return mesh;
}

bool is_union_of_all(const Model& model) {
  if (!model.csg) return true;
  if (model.primitives.size() == 1) return model.csg->operation == SetOperation::unite || model.csg->operands.empty();
  return false;
}

/// Returns whether any two primitives are proven farther apart than `gap`. `surfaces` are the primitives' surfaces,
/// whose points decide most pairs.
bool apart(const Model& model, const Solid& solid, const std::vector<Mesh>& surfaces, double gap,
           const std::function<bool()>& interrupted) {
  const auto contains_some = [&](std::size_t i, std::size_t j) {
    return std::ranges::any_of(surfaces[j].vertices,
                               [&](const Point& point) { return solid.primitives()[i].contains(vector_of(point)); });
  };
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (contains_some(i, j) || contains_some(j, i)) return false;
      const verify::PairSearch search({"", {model.primitives[i]}}, {"", {model.primitives[j]}});
      if (!(search({}, {.tolerance = gap, .interrupted = interrupted}).distance.lo > gap)) return false;
    }
  }
  return true;
}

/// Points of the primitives' surfaces that lie on the solid's, and where out is.
struct SurfacePoint {
  Eigen::Vector3d inside, outside;  ///< on both sides, the deviation away
};

std::vector<SurfacePoint> surface_points(const Solid& solid, const std::vector<Mesh>& surfaces, double deviation,
                                         const std::function<bool()>& interrupted) {
  std::vector<SurfacePoint> points;
  for (const Mesh& surface : surfaces) {
    for (const Point& vertex : surface.vertices) {
      if (interrupted()) return points;
      const Eigen::Vector3d point = vector_of(vertex);
      const Eigen::Vector3d offset = deviation * solid.outward(point, deviation / 16.0);
      if (solid.contains(point - offset) && !solid.contains(point + offset)) {
        points.push_back({point - offset, point + offset});
      }
    }
  }
  return points;
}

class Marching {
 public:
  Marching(const Solid& solid, const std::vector<Mesh>& surfaces, const ModelMeshOptions& options, double unit)
      : solid_(solid),
        options_(options),
        unit_(unit),
        deviation_(share_of_samples * options.deviation),
        extent_(extent_of_all(surfaces)),
        width_(2.2 * extent_.half_size() + 4.0 * options.deviation),
        grid_(corner(), width_),
        marcher_(solid, grid_),
        points_(surface_points(solid, surfaces, deviation_, options.interrupted)) {}

  /// Nothing if interrupted.
  Triangles run() && {
    refine_to_parts();
    TetrahedraSurface surface;
    for (double round = 0.0; !options_.interrupted(); ++round) {
      options_.progress("refining", 0.7 * (1.0 - std::exp2(-round / 8.0)));
      surface = marcher_.surface(options_.interrupted);
      if (options_.interrupted()) break;
      if (surface.triangles.size() > options_.most_triangles) refuse_size();
      const std::vector<bool> moved = snap_to_creases(solid_, surface, options_.interrupted);
      const std::vector<std::uint32_t> bad = unlike_solid(surface, moved);
      if (bad.empty()) break;
      bisect(bad);
    }
    if (options_.interrupted()) return {};
    if (surface.triangles.empty())
      throw Error(ErrorKind::input, "model: its solid has no point, or is thinner than the deviation");
    options_.progress("thinning out", 0.7);
    return collapse_edges(solid_, {std::move(surface.vertices), std::move(surface.triangles)}, deviation_,
                          options_.interrupted);
  }

 private:
  static Extent extent_of_all(const std::vector<Mesh>& surfaces) {
    std::vector<Point> points;
    for (const Mesh& surface : surfaces) points.insert(points.end(), surface.vertices.begin(), surface.vertices.end());
    return extent_of(points);
  }

  /// Off the centre by fractions without a pattern: no vertex of the grid should lie on a plane of the model.
  [[nodiscard]] Eigen::Vector3d corner() const {
    return vector_of(extent_.centre()) - width_ * Eigen::Vector3d(0.5071828, 0.5041592, 0.5014142);
  }

  /// Until no tetrahedron near the surface is larger than the thinnest primitive.
  void refine_to_parts() {
    double part = width_;
    for (const PlacedPrimitive& primitive : solid_.primitives()) part = std::min(part, primitive.smallest_semi_axis());
    const double size = std::clamp(part, width_ / 128.0, width_ / 12.0);
    for (std::vector<std::uint32_t> marked = near_surface(0, size); !marked.empty() && !options_.interrupted();) {
      const auto known = static_cast<std::uint32_t>(grid_.tetrahedra().size());
      bisect(marked);
      marked = near_surface(known, size);
    }
  }

  /// Bisects all of them, unless interrupted.
  void bisect(std::span<const std::uint32_t> marked) {
    constexpr std::size_t between_polls = 1024;
    for (; !marked.empty() && !options_.interrupted(); marked = marked.subspan(std::min(between_polls, marked.size())))
      grid_.bisect(marked.first(std::min(between_polls, marked.size())));
  }

  /// If interrupted, only some of them.
  [[nodiscard]] std::vector<std::uint32_t> near_surface(std::uint32_t first, double size) const {
    std::vector<std::uint32_t> marked;
    for (std::uint32_t k = first; k < grid_.tetrahedra().size() && !options_.interrupted(); ++k) {
      if (!grid_.is_leaf(k)) continue;
      const double own = grid_.size(k);
      Eigen::Vector3d centre = Eigen::Vector3d::Zero();
      for (const std::uint32_t corner : grid_.tetrahedra()[k].corners) centre += grid_.vertices()[corner] / 4.0;
      if (own > size && std::abs(solid_.level(centre).value) < own) marked.push_back(k);
    }
    return marked;
  }

  /// Tetrahedra, not too small, in which the surface and the solid's are too far from each other at a sample.
  [[nodiscard]] std::vector<std::uint32_t> unlike_solid(const TetrahedraSurface& surface,
                                                        const std::vector<bool>& moved) {
    std::vector<std::uint32_t> bad = far_triangles(surface, moved);
    add_missed_points(bad);
    std::ranges::sort(bad);
    bad.erase(std::unique(bad.begin(), bad.end()), bad.end());
    std::erase_if(bad, [&](std::uint32_t k) { return grid_.size(k) < smallest_tetrahedron * options_.deviation; });
    return bad;
  }

  [[nodiscard]] std::vector<std::uint32_t> far_triangles(const TetrahedraSurface& surface,
                                                         const std::vector<bool>& moved) {
    near_.resize(grid_.tetrahedra().size(), 0);
    const std::size_t count = surface.triangles.size();
    std::vector<std::uint8_t> far(count, 0);
    std::vector<std::uint8_t> fixed(count, 0);
    in_parallel((count + triangles_a_chunk - 1) / triangles_a_chunk, [&](std::size_t chunk) {
      if (options_.interrupted()) return;  // what is not looked at is not used: run() asks, too
      const std::size_t last = std::min(count, (chunk + 1) * triangles_a_chunk);
      for (std::size_t t = chunk * triangles_a_chunk; t < last; ++t) {
        const auto& [a, b, c] = surface.triangles[t];
        fixed[t] = !(moved[a] || moved[b] || moved[c]) ? 1 : 0;
        if (fixed[t] != 0 && near_[surface.tetrahedra[t]] != 0) continue;
        const auto& p = surface.primitives;
        const bool one_primitive = fixed[t] != 0 && p[a] == p[b] && p[b] == p[c];
        const TriangleCorners corners{surface.vertices[a], surface.vertices[b], surface.vertices[c]};
        far[t] = within(solid_, corners, deviation_, one_primitive ? Sampling::usual : Sampling::fine) ? 0 : 1;
      }
    });
    std::vector<std::uint32_t> result;
    for (std::size_t t = 0; t < count; ++t) {
      const std::uint32_t k = surface.tetrahedra[t];
      // One far triangle of two makes the tetrahedron far, in whatever order they come.
      if (fixed[t] != 0 && near_[k] == 0) near_[k] = 1;
      if (far[t] != 0) result.push_back(k);
    }
    for (const std::uint32_t k : result) near_[k] = 0;
    return result;
  }

  void add_missed_points(std::vector<std::uint32_t>& bad) const {
    for (const SurfacePoint& point : points_) {
      if (options_.interrupted()) return;
      for (const bool inside : {true, false}) {
        const std::uint32_t k = grid_.leaf_at(inside ? point.inside : point.outside);
        const auto& corners = grid_.tetrahedra()[k].corners;
        const auto beside = [&](std::uint32_t corner) { return marcher_.inside(corner) != inside; };
        if (!std::ranges::all_of(corners, beside)) continue;
        bad.push_back(k);
        bad.push_back(grid_.leaf_at((point.inside + point.outside) / 2.0));
      }
    }
  }

  [[noreturn]] void refuse_size() const {
    throw Error(ErrorKind::input, fmt::format("deviation {:g}: the mesh has more than {} triangles; give a larger one",
                                              options_.deviation * unit_, options_.most_triangles));
  }

  const Solid& solid_;
  const ModelMeshOptions& options_;
  double unit_;
  double deviation_;
  Extent extent_;
  double width_;
  BisectedTetrahedra grid_;
  SurfaceMarcher marcher_;
  std::vector<SurfacePoint> points_;
  std::vector<std::uint8_t> near_;  // of each tetrahedron: whether its triangles are known to be near enough
};

void estimate(const Solid& solid, const ModelMeshOptions& options, ModelMesh& result) {
  const Mesh& mesh = result.mesh;
  std::vector<double> largest((mesh.triangles.size() + triangles_a_chunk - 1) / triangles_a_chunk);
  in_parallel(largest.size(), [&](std::size_t chunk) {
    if (options.interrupted()) return;
    double deviation = options.deviation / 64.0;
    const std::size_t last = std::min(mesh.triangles.size(), (chunk + 1) * triangles_a_chunk);
    for (std::size_t t = chunk * triangles_a_chunk; t < last; ++t) {
      const auto& [a, b, c] = mesh.triangles[t];
      const TriangleCorners corners{vector_of(mesh.vertices[a]), vector_of(mesh.vertices[b]),
                                    vector_of(mesh.vertices[c])};
      deviation = sampled_deviation(solid, corners, deviation, 16.0 * options.deviation, Sampling::fine);
    }
    largest[chunk] = deviation;
  });
  result.estimated_deviation = *std::ranges::max_element(largest);
  result.samples = samples_of(Sampling::fine) * mesh.triangles.size();
}

/// Model and options are in units of `unit`; messages state lengths.
ModelMesh meshed(const Model& model, const ModelMeshOptions& options, double unit) {
  const double deviation = options.deviation;
  const Solid solid(model);
  double largest = 0.0;
  for (const PlacedPrimitive& primitive : solid.primitives()) {
    largest = std::max(largest, primitive.centre().cwiseAbs().maxCoeff() + primitive.radius());
  }
  const double farthest = largest * unit;  // rounded as the vertices will be: tiny ones have fewer digits
  if (!(std::nextafter(farthest, infinity) - farthest <= largest_rounding * deviation * unit))
    throw Error(ErrorKind::input,
                fmt::format("deviation {:g}: lost in the rounding of coordinates of {:g}", deviation * unit, farthest));
  options.progress("gridding", 0.0);
  std::vector<Mesh> surfaces;
  for (const PlacedPrimitive& primitive : solid.primitives())
    surfaces.push_back(parametric_surface(primitive, deviation));

  ModelMesh result;
  if (is_union_of_all(model) && apart(model, solid, surfaces, deviation, options.interrupted)) {
    for (const Mesh& surface : surfaces) append(result.mesh, surface);
  } else {
    result.mesh = mesh_of(Marching(solid, surfaces, options, unit).run());
  }
  result.interrupted = options.interrupted();
  if (result.interrupted) return {.mesh = {}, .interrupted = true};
  options.progress("sampling", 0.95);
  estimate(solid, options, result);
  if (options.interrupted()) return {.mesh = {}, .interrupted = true};
  return result;
}

}  // namespace
}  // namespace tessellation

namespace {

/// A model of one mesh has that surface, turned outward.
Mesh own_surface(const Model& model) {
  if (model.primitives.size() > 1 || model.csg)
    throw Error(ErrorKind::input, "a mesh among several primitives: so far superquadrics, or one mesh, have a surface");
  Mesh mesh = verify::placed(model.primitives.front()).mesh;
  if (volume_sign(mesh) < 0)
    for (auto& [a, b, c] : mesh.triangles) std::swap(b, c);
  return mesh;
}

}  // namespace

ModelMesh model_mesh(const Model& model, const ModelMeshOptions& options) {
  verify::require_valid_with_meshes(model);
  if (!(options.deviation > 0.0) || !std::isfinite(options.deviation))
    throw Error(ErrorKind::input, fmt::format("deviation: {:g} is not a positive number", options.deviation));
  if (has_mesh(model)) return {.mesh = own_surface(model)};
  const double unit = verify::unit_of(model, model);
  ModelMeshOptions scaled = options;
  scaled.deviation = verify::tolerance_in_units(options.deviation, unit);
  ModelMesh result = tessellation::meshed(verify::in_units(model, unit), scaled, unit);
  for (Point& vertex : result.mesh.vertices) {
    for (double& coordinate : vertex) coordinate *= unit;
  }
  result.estimated_deviation *= unit;
  return result;
}

}  // namespace verisq

namespace verisq::tessellation {
namespace {

constexpr std::array<std::array<std::size_t, 2>, 6> tetrahedron_edges{{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

double determinant(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                   const Eigen::Vector3d& d) {
  return (b - a).cross(c - a).dot(d - a);
}

}  // namespace

BisectedTetrahedra::BisectedTetrahedra(const Eigen::Vector3d& lower, double width) {
  for (unsigned corner = 0; corner < 8; ++corner) {
    vertices_.push_back(lower + width * Eigen::Vector3d(corner & 1U, corner >> 1U & 1U, corner >> 2U & 1U));
  }
  leaves_at_.resize(8);
  // Kuhn: one tetrahedron for each order of the three axes along a path from corner 0 to corner 7.
  std::array<unsigned, 3> axes{1, 2, 4};
  do {
    add_leaf({0, axes[0], axes[0] | axes[1], 7}, 3);
  } while (std::ranges::next_permutation(axes).found);
}

double BisectedTetrahedra::size(std::uint32_t k) const {
  double longest = 0.0;
  for (const auto& [i, j] : tetrahedron_edges) {
    const auto& corners = tetrahedra_[k].corners;
    longest = std::max(longest, (vertices_[corners[i]] - vertices_[corners[j]]).norm());
  }
  return longest;
}

void BisectedTetrahedra::bisect(std::span<const std::uint32_t> marked) {
  std::vector<std::uint32_t> open;
  for (const std::uint32_t k : marked) {
    if (is_leaf(k)) split(k, open);
    while (!open.empty()) {
      const std::uint32_t next = open.back();
      open.pop_back();
      if (is_leaf(next) && has_split_edge(tetrahedra_[next])) split(next, open);
    }
  }
}

std::uint32_t BisectedTetrahedra::leaf_at(const Eigen::Vector3d& point) const {
  // The least barycentric coordinate, up to a factor that is the same for siblings.
  const auto depth_in = [&](std::uint32_t k) {
    const auto& [a, b, c, d] = tetrahedra_[k].corners;
    const auto& v = vertices_;
    const double whole = determinant(v[a], v[b], v[c], v[d]);
    return std::min({determinant(point, v[b], v[c], v[d]) / whole, determinant(v[a], point, v[c], v[d]) / whole,
                     determinant(v[a], v[b], point, v[d]) / whole, determinant(v[a], v[b], v[c], point) / whole});
  };
  std::uint32_t k = 0;
  for (std::uint32_t root = 1; root < 6; ++root) {
    if (depth_in(root) > depth_in(k)) k = root;
  }
  while (!is_leaf(k)) {
    const std::uint32_t child = tetrahedra_[k].first_child;
    k = depth_in(child) >= depth_in(child + 1) ? child : child + 1;
  }
  return k;
}

void BisectedTetrahedra::add_leaf(const std::array<std::uint32_t, 4>& corners, std::uint8_t tag) {
  for (const std::uint32_t corner : corners) {
    leaves_at_[corner].push_back(static_cast<std::uint32_t>(tetrahedra_.size()));
  }
  tetrahedra_.push_back({corners, tag});
}

void BisectedTetrahedra::split(std::uint32_t k, std::vector<std::uint32_t>& open) {
  const auto [corners, tag, unused] = tetrahedra_[k];
  const std::uint32_t a = corners[0];
  const std::uint32_t b = corners[tag];
  const std::uint32_t middle = middle_of(a, b);
  for (const std::uint32_t corner : corners) std::erase(leaves_at_[corner], k);
  for (const std::uint32_t leaf : leaves_at_[a]) {
    if (std::ranges::count(tetrahedra_[leaf].corners, b) > 0) open.push_back(leaf);
  }
  tetrahedra_[k].first_child = static_cast<std::uint32_t>(tetrahedra_.size());
  std::array<std::uint32_t, 4> first = corners;
  first[tag] = middle;
  std::array<std::uint32_t, 4> second = corners;
  for (std::size_t i = 0; i < tag; ++i) second[i] = corners[i + 1];
  second[tag] = middle;
  const std::uint8_t next_tag = tag > 1 ? tag - 1 : 3;
  for (const auto& child : {first, second}) {
    open.push_back(static_cast<std::uint32_t>(tetrahedra_.size()));
    add_leaf(child, next_tag);
  }
}

bool BisectedTetrahedra::has_split_edge(const Tetrahedron& tetrahedron) const {
  const auto& corners = tetrahedron.corners;
  return std::ranges::any_of(tetrahedron_edges, [&](const auto& edge) {
    return middles_.contains(edge_key(corners[edge[0]], corners[edge[1]]));
  });
}

std::uint32_t BisectedTetrahedra::middle_of(std::uint32_t a, std::uint32_t b) {
  const auto [place, added] = middles_.try_emplace(edge_key(a, b), static_cast<std::uint32_t>(vertices_.size()));
  if (added) {
    vertices_.push_back((vertices_[a] + vertices_[b]) / 2.0);
    leaves_at_.emplace_back();
  }
  return place->second;
}

namespace {

/// Share of an edge: vertices nearer to its end would make triangles of no area once coordinates are rounded.
constexpr double closest_to_end = 1e-3;
constexpr std::size_t vertices_a_chunk = 1024;

}  // namespace

void SurfaceMarcher::classify(const std::function<bool()>& interrupted) {
  const std::size_t known = inside_.size();
  const std::size_t count = grid_.vertices().size();
  inside_.resize(count);
  const std::size_t chunks = (count - known + vertices_a_chunk - 1) / vertices_a_chunk;
  in_parallel(chunks, [&](std::size_t chunk) {
    if (interrupted()) return;
    const std::size_t first = known + chunk * vertices_a_chunk;
    const std::size_t last = std::min(count, first + vertices_a_chunk);
    for (std::size_t v = first; v < last; ++v) inside_[v] = solid_.contains(grid_.vertices()[v]) ? 1 : 0;
  });
}

TetrahedraSurface SurfaceMarcher::surface(const std::function<bool()>& interrupted) {
  classify(interrupted);
  indices_.clear();
  TetrahedraSurface result;
  for (std::uint32_t k = 0; k < grid_.tetrahedra().size() && !interrupted(); ++k) {
    if (grid_.is_leaf(k)) add_triangles(k, result);
  }
  return result;
}

void SurfaceMarcher::add_triangles(std::uint32_t k, TetrahedraSurface& surface) {
  std::array<std::uint32_t, 4> corners = grid_.tetrahedra()[k].corners;
  const auto is_outside = [&](std::uint32_t corner) { return inside_[corner] == 0; };
  const auto outside = std::ranges::count_if(corners, is_outside);
  if (outside == 0 || outside == 4) return;
  std::stable_partition(corners.begin(), corners.end(), [&](std::uint32_t corner) { return !is_outside(corner); });
  const auto& v = grid_.vertices();
  const Eigen::Vector3d& apex = v[corners[0]];
  const double volume = (v[corners[1]] - apex).cross(v[corners[2]] - apex).dot(v[corners[3]] - apex);
  if (volume < 0.0) outside == 1 ? std::swap(corners[0], corners[1]) : std::swap(corners[2], corners[3]);
  const auto [a, b, c, d] = corners;
  const auto on = [&](std::uint32_t p, std::uint32_t q) { return vertex_on(p, q, surface); };
  const auto add = [&](std::uint32_t p, std::uint32_t q, std::uint32_t r) {
    surface.triangles.push_back({p, q, r});
    surface.tetrahedra.push_back(k);
  };
  if (outside == 3) return add(on(a, b), on(a, c), on(a, d));
  if (outside == 1) return add(on(a, d), on(b, d), on(c, d));
  const std::array<std::uint32_t, 4> quad{on(a, c), on(a, d), on(b, d), on(b, c)};
  const auto length = [&](std::size_t i, std::size_t j) {
    return (surface.vertices[quad[i]] - surface.vertices[quad[j]]).norm();
  };
  const std::size_t first = length(0, 2) < length(1, 3) ? 0 : 1;
  add(quad[first], quad[first + 1], quad[first + 2]);
  add(quad[first], quad[first + 2], quad[(first + 3) % 4]);
}

std::uint32_t SurfaceMarcher::vertex_on(std::uint32_t a, std::uint32_t b, TetrahedraSurface& surface) {
  const std::uint64_t key = edge_key(a, b);
  const auto [place, added] = indices_.try_emplace(key, static_cast<std::uint32_t>(surface.vertices.size()));
  if (!added) return place->second;
  auto known = crossings_.find(key);
  if (known == crossings_.end()) known = crossings_.emplace(key, crossing(a, b)).first;
  surface.vertices.push_back(known->second.point);
  surface.primitives.push_back(known->second.primitive);
  return place->second;
}

SurfaceMarcher::Crossing SurfaceMarcher::crossing(std::uint32_t inside, std::uint32_t outside) const {
  const Eigen::Vector3d& from = grid_.vertices()[inside];
  const Eigen::Vector3d& to = grid_.vertices()[outside];
  const double t = std::clamp(solid_.crossing(from, to), closest_to_end, 1.0 - closest_to_end);
  const Eigen::Vector3d point = from + t * (to - from);
  return {point, solid_.level(point).primitive};
}

}  // namespace verisq::tessellation
