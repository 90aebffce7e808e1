/// Distances from the bone's surface by CGAL (GPL), sampled where the canal may end.
#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/boost/graph/helpers.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>
#include <verisq/error.hpp>
#include <verisq/mesh_topology.hpp>
#include <verisq/surface.hpp>

#include "host/prepare/mesh_geometry.hpp"
#include "host/surface/surface_steps.hpp"
#include "verify/numbers/points.hpp"
#include "verify/proof/closed_surface.hpp"

namespace verisq {
namespace {

using surface::CgalMesh;
using BoneTraits = CGAL::AABB_traits<surface::Kernel, CGAL::AABB_face_graph_triangle_primitive<CgalMesh>>;
using BoneTree = CGAL::AABB_tree<BoneTraits>;
using BoneSide = CGAL::Side_of_triangle_mesh<CgalMesh, surface::Kernel, CGAL::Default, BoneTree>;

constexpr double samples_of_longest_side = 200.0;

/// A mesh and a search tree for its nearest triangle; it must not be moved, because the tree points to the mesh.
class NearestTriangle {
 public:
  explicit NearestTriangle(const Mesh& mesh)
      : mesh_(surface::halfedge_mesh(mesh)), tree_(faces(mesh_).begin(), faces(mesh_).end(), mesh_) {
    tree_.accelerate_distance_queries();
  }
  NearestTriangle(const NearestTriangle&) = delete;
  NearestTriangle& operator=(const NearestTriangle&) = delete;

  [[nodiscard]] double distance(const Point& x) const { return std::sqrt(tree_.squared_distance({x[0], x[1], x[2]})); }
  [[nodiscard]] const CgalMesh& mesh() const { return mesh_; }
  [[nodiscard]] const BoneTree& tree() const { return tree_; }

 private:
  CgalMesh mesh_;
  BoneTree tree_;
};

struct ClosedBone {
  Mesh mesh;
  std::size_t rims;  ///< number of rims that fans close
};

/// Throws Error(input) where the mesh is no surface.
ClosedBone closed_over_rims(const Mesh& mesh) {
  if (const std::size_t edges = mesh_topology(mesh).non_manifold_edges; edges > 0) {
    throw Error(ErrorKind::input, fmt::format("the bone has no inside: more than two triangles meet at {} of its edges "
                                              "(verisq surface --method wrap mends that)",
                                              edges));
  }
  Mesh closed = surface::indexed_mesh(surface::halfedge_mesh(mesh));  // turned alike, as the closing expects it
  const verify::Closing closing = verify::closing_over_rims(closed);
  if (closing.rims > 0) closed.vertices = closing.mesh.vertices;
  closed.triangles.insert(closed.triangles.end(), closing.mesh.triangles.begin(), closing.mesh.triangles.end());
  return {std::move(closed), closing.rims};
}

/// The cortex begins at the bone's own triangles; the inside is enclosed by these and the fans over its rims.
class BoneDepth {
 public:
  BoneDepth(const Mesh& bone, const ClosedBone& closed) : outer_(bone), solid_(closed.mesh) {
    if (!CGAL::is_closed(solid_.mesh()))
      throw Error(ErrorKind::input, "the bone has no inside: its surface has one side only, like a Moebius strip");
    side_ = std::make_unique<BoneSide>(solid_.tree());
  }

  /// How much farther than `thickness` x lies from the bone's triangles, if it lies inside; negative in the cortex and
  /// outside. If the value is d > 0 or -d < 0, it keeps its sign as long as x and the thickness change by less than d.
  [[nodiscard]] double beyond_cortex(const Point& x, double thickness) const {
    const double to_solid = solid_.distance(x);
    if ((*side_)({x[0], x[1], x[2]}) == CGAL::ON_UNBOUNDED_SIDE) return -to_solid;
    return std::min(outer_.distance(x) - thickness, to_solid);
  }

 private:
  NearestTriangle outer_;
  NearestTriangle solid_;
  std::unique_ptr<BoneSide> side_;
};

double length(const Point& x) {
  return std::hypot(x[0], x[1], x[2]);
}

/// The largest change of the thickness over a unit of length.
double slope_of(const CorticalThickness& thickness) {
  double steepest = 0.0;
  for (std::size_t k = 0; k + 1 < thickness.at.size(); ++k) {
    const double rise = thickness.at[k + 1].thickness - thickness.at[k].thickness;
    steepest = std::max(steepest, std::abs(rise / (thickness.at[k + 1].height - thickness.at[k].height)));
  }
  return steepest;
}

double chosen_spacing(const Extent& extent, const CorticalThickness& thickness) {
  double spacing = 2.0 * extent.half_size() / samples_of_longest_side;
  for (const auto& [height, wall] : thickness.at)
    if (wall > 0.0) spacing = std::min(spacing, wall / 2.0);
  return spacing;
}

/// Around the bone's box by more than one step.
surface::GridSamples grid_around(const Extent& extent, double spacing) {
  surface::GridSamples grid{.counts = {},
                            .origin = {},
                            .steps = {Point{spacing, 0.0, 0.0}, Point{0.0, spacing, 0.0}, Point{0.0, 0.0, spacing}},
                            .values = {}};
  double samples = 1.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double steps = std::ceil((extent.upper[axis] - extent.lower[axis]) / spacing) + 4.0;
    samples *= steps;
    constexpr double most = 1e9;  // 4 GB
    if (!(samples <= most))
      throw Error(ErrorKind::input,
                  fmt::format("a spacing of {}: more than {} samples of the bone's box", spacing, most));
    grid.counts[axis] = static_cast<std::size_t>(steps);
    grid.origin[axis] = extent.lower[axis] - 1.5 * spacing;
  }
  grid.values.assign(grid.counts[0] * grid.counts[1] * grid.counts[2], 0.0F);
  return grid;
}

/// Samples cubes of the lattice, each first in its middle. If the middle decides all of the cube and its neighbours,
/// their samples are skipped.
class CubeSampler {
 public:
  CubeSampler(const BoneDepth& bone, const CorticalThickness& thickness, surface::GridSamples& grid)
      : bone_(bone), thickness_(thickness), grid_(grid), spacing_(grid.steps[0][0]) {
    // The distance from the middle to a corner, and a step of the lattice farther, where a neighbour may be.
    const double reach = spacing_ * std::numbers::sqrt3 * (static_cast<double>(side - 1) / 2.0 + 1.0);
    surely_ = (1.0 + slope_of(thickness)) * reach;
  }

  void operator()() const {
    for (std::size_t k = 0; k < grid_.counts[2]; k += side)
      for (std::size_t j = 0; j < grid_.counts[1]; j += side)
        for (std::size_t i = 0; i < grid_.counts[0]; i += side) sample({i, j, k});
  }

 private:
  static constexpr std::size_t side = 4;

  [[nodiscard]] float value(const Point& x) const { return static_cast<float>(bone_.beyond_cortex(x, thickness_(x))); }

  void sample(const std::array<std::size_t, 3>& first) const {
    Point middle = grid_.point(first[0], first[1], first[2]);
    for (double& x : middle) x += spacing_ * static_cast<double>(side - 1) / 2.0;
    const float there = value(middle);
    const bool sure = std::abs(static_cast<double>(there)) > surely_;
    for (std::size_t k = first[2]; k < std::min(first[2] + side, grid_.counts[2]); ++k)
      for (std::size_t j = first[1]; j < std::min(first[1] + side, grid_.counts[1]); ++j)
        for (std::size_t i = first[0]; i < std::min(first[0] + side, grid_.counts[0]); ++i)
          grid_.values[grid_.index(i, j, k)] = sure ? there : value(grid_.point(i, j, k));
  }

  const BoneDepth& bone_;
  const CorticalThickness& thickness_;
  surface::GridSamples& grid_;
  double spacing_;
  double surely_;
};

}  // namespace

double CorticalThickness::operator()(const Point& x) const {
  if (at.size() == 1) return at.front().thickness;
  const Point along = verify::near_one(axis);
  const double height = (x[0] * along[0] + x[1] * along[1] + x[2] * along[2]) / length(along);
  const auto above = std::ranges::upper_bound(at, height, {}, &ThicknessAtHeight::height);
  if (above == at.begin()) return at.front().thickness;
  if (above == at.end()) return at.back().thickness;
  const ThicknessAtHeight& below = *(above - 1);
  const double share = (height - below.height) / (above->height - below.height);
  return below.thickness + share * (above->thickness - below.thickness);
}

Canal canal_of(const Mesh& bone, const CanalOptions& options) {
  if (bone.triangles.empty()) throw Error(ErrorKind::input, "the bone has no triangles: a canal needs its surface");
  const ClosedBone closed = closed_over_rims(bone);
  const BoneDepth depth(bone, closed);
  const Extent extent = extent_of(bone.vertices);
  const double spacing = options.spacing.value_or(chosen_spacing(extent, options.thickness));
  surface::GridSamples grid = grid_around(extent, spacing);
  CubeSampler(depth, options.thickness, grid)();
  surface::LargestPart part = surface::largest_part(surface::level_surface(grid));
  if (part.mesh.triangles.empty())
    throw Error(ErrorKind::input, "nothing is left of the bone: it is nowhere thicker than two cortices");
  return {.mesh = std::move(part.mesh),
          .spacing = spacing,
          .parts_left_out = part.parts_left_out,
          .rims_closed = closed.rims};
}

WallCheck check_wall(const Mesh& canal, const Mesh& bone, const CorticalThickness& thickness) {
  const NearestTriangle outer(bone);
  WallCheck check{.least = std::numeric_limits<double>::infinity()};
  for (const Point& x : canal.vertices) {
    const double wall = outer.distance(x);
    check.least = std::min(check.least, wall);
    check.largest = std::max(check.largest, wall);
    check.mean += wall / static_cast<double>(canal.vertices.size());
    check.largest_error = std::max(check.largest_error, std::abs(wall - thickness(x)));
  }
  return check;
}

}  // namespace verisq
