/// Grids for what is apart, tetrahedra for what meets: refined until samples agree, then thinned out.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <mutex>
#include <utility>
#include <verisq/error.hpp>
#include <verisq/model_mesh.hpp>
#include <verisq/model_search.hpp>

#include "host/mesh/eigen_points.hpp"
#include "host/mesh/extent.hpp"
#include "host/tessellation/bisected_tetrahedra.hpp"
#include "host/tessellation/crease_snapping.hpp"
#include "host/tessellation/edge_collapse.hpp"
#include "host/tessellation/parametric_surface.hpp"
#include "host/tessellation/sampled_deviation.hpp"
#include "host/tessellation/solid.hpp"
#include "host/tessellation/tetrahedra_surface.hpp"
#include "host/threads/parallel.hpp"

namespace verisq {
namespace tessellation {
namespace {

/// Of the deviation: what samples may show, so that what lies between them stays below the whole.
constexpr double share_of_samples = 0.5;
/// Of the deviation: tetrahedra below this size are refined no more.
constexpr double smallest_tetrahedron = 0.25;
/// Of the deviation a coordinate's last bit may be.
constexpr double largest_rounding = 1e-3;
constexpr std::size_t triangles_a_chunk = 512;

Mesh mesh_of(const Triangles& triangles) {
  Mesh mesh;
  for (const Eigen::Vector3d& vertex : triangles.vertices) mesh.vertices.push_back(point_of(vertex));
  mesh.triangles = triangles.triangles;
  return mesh;
}

void append(Mesh& mesh, const Mesh& other) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({a + first, b + first, c + first});
}

bool is_union_of_all(const Model& model) {
  if (!model.csg) return true;
  if (model.primitives.size() == 1) return model.csg->operation == SetOperation::unite || model.csg->operands.empty();
  return false;
}

/// Whether any two primitives are proven farther apart than `gap`. `surfaces`: theirs, points of which decide most.
bool apart(const Model& model, const Solid& solid, const std::vector<Mesh>& surfaces, double gap,
           const std::function<bool()>& interrupted) {
  const auto contains_some = [&](std::size_t i, std::size_t j) {
    return std::ranges::any_of(surfaces[j].vertices,
                               [&](const Point& point) { return solid.primitives()[i].contains(vector_of(point)); });
  };
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (contains_some(i, j) || contains_some(j, i)) return false;
      const ModelSearch search({"", {model.primitives[i]}}, {"", {model.primitives[j]}});
      if (!(search({}, {.tolerance = gap, .interrupted = interrupted}).distance.lo > gap)) return false;
    }
  }
  return true;
}

/// Points of the primitives' surfaces that lie on the solid's, and where out is.
struct SurfacePoint {
  Eigen::Vector3d inside, outside;  ///< on both sides, the deviation away
};

std::vector<SurfacePoint> surface_points(const Solid& solid, const std::vector<Mesh>& surfaces, double deviation) {
  std::vector<SurfacePoint> points;
  for (const Mesh& surface : surfaces) {
    for (const Point& vertex : surface.vertices) {
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
  Marching(const Solid& solid, const std::vector<Mesh>& surfaces, const ModelMeshOptions& options)
      : solid_(solid),
        options_(options),
        deviation_(share_of_samples * options.deviation),
        extent_(extent_of_all(surfaces)),
        width_(2.2 * extent_.half_size() + 4.0 * options.deviation),
        grid_(corner(), width_),
        marcher_(solid, grid_),
        points_(surface_points(solid, surfaces, deviation_)) {}

  /// Nothing where interrupted.
  Triangles run() && {
    refine_to_parts();
    TetrahedraSurface surface;
    for (double round = 0.0; !options_.interrupted(); ++round) {
      options_.progress("refining", 0.7 * (1.0 - std::exp2(-round / 8.0)));
      surface = marcher_.surface();
      if (surface.triangles.size() > options_.most_triangles) refuse_size();
      const std::vector<bool> moved = snap_to_creases(solid_, surface);
      const std::vector<std::uint32_t> bad = unlike_solid(surface, moved);
      if (bad.empty()) break;
      grid_.bisect(bad);
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
    for (std::vector<std::uint32_t> marked = near_surface(0, size); !marked.empty();) {
      const auto known = static_cast<std::uint32_t>(grid_.tetrahedra().size());
      grid_.bisect(marked);
      marked = near_surface(known, size);
    }
  }

  [[nodiscard]] std::vector<std::uint32_t> near_surface(std::uint32_t first, double size) const {
    std::vector<std::uint32_t> marked;
    for (std::uint32_t k = first; k < grid_.tetrahedra().size(); ++k) {
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
                                              options_.deviation, options_.most_triangles));
  }

  const Solid& solid_;
  const ModelMeshOptions& options_;
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

}  // namespace
}  // namespace tessellation

ModelMesh model_mesh(const Model& model, const ModelMeshOptions& options) {
  using namespace tessellation;
  const double deviation = options.deviation;
  if (!(deviation > 0.0) || !std::isfinite(deviation))
    throw Error(ErrorKind::input, fmt::format("deviation: {:g} is not a positive number", deviation));
  const Solid solid(model);
  double largest = 0.0;
  for (const PlacedPrimitive& primitive : solid.primitives()) {
    largest = std::max(largest, primitive.centre().cwiseAbs().maxCoeff() + primitive.radius());
  }
  if (std::nextafter(largest, 2.0 * largest) - largest > largest_rounding * deviation)
    throw Error(ErrorKind::input,
                fmt::format("deviation {:g}: lost in the rounding of coordinates of {:g}", deviation, largest));
  options.progress("gridding", 0.0);
  std::vector<Mesh> surfaces;
  for (const PlacedPrimitive& primitive : solid.primitives())
    surfaces.push_back(parametric_surface(primitive, deviation));

  ModelMesh result;
  if (is_union_of_all(model) && apart(model, solid, surfaces, deviation, options.interrupted)) {
    for (const Mesh& surface : surfaces) append(result.mesh, surface);
  } else {
    result.mesh = mesh_of(Marching(solid, surfaces, options).run());
  }
  result.interrupted = options.interrupted();
  if (result.interrupted) return {.mesh = {}, .interrupted = true};
  options.progress("sampling", 0.95);
  estimate(solid, options, result);
  if (options.interrupted()) return {.mesh = {}, .interrupted = true};
  return result;
}

}  // namespace verisq
