/// Prepares the surface of a bone or a cavity from a point cloud or a damaged mesh: the steps of the paper's Figure 4.
/// Only in builds with CGAL, whose parts used here are under the GPL (CMake option VERISQ_SURFACE; link
/// verisq::surface). All numbers are floating point: nothing here is an enclosure.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <verisq/mesh.hpp>
#include <verisq/mesh_topology.hpp>
#include <verisq/plane.hpp>

namespace verisq {

enum class SurfaceMethod {
  given,        ///< the triangles of the input, turned alike
  wrap,         ///< alpha wrap: around the triangles of the input or, where it has none, around its vertices
  alpha_shape,  ///< through the vertices of the input; its triangles do not count
};

/// Which way the normals point; inward is for cavities (the paper, section 4).
enum class Facing { outward, inward };

struct SurfaceOptions {
  SurfaceMethod method = SurfaceMethod::wrap;
  /// Radius of the balls that carve the space outside; wider gaps of the input let them in. Nothing: chosen, see
  /// `PreparedSurface`. Positive.
  std::optional<double> alpha = std::nullopt;
  /// Of the wrap: how far it keeps from the input; positive. Nothing: alpha / 100.
  std::optional<double> offset = std::nullopt;
  /// Of a given mesh; the other methods leave no holes.
  bool fill_holes = false;
  /// Rounds of Taubin's smoothing; at least 0.
  int smoothing_rounds = 0;
  /// Where the surface is cut and left open: without what lies beyond, of the rest the part of the largest area.
  std::optional<Plane> opening = std::nullopt;
  /// Triangles of about equal sides, this long; nothing: as they come. Positive.
  std::optional<double> edge = std::nullopt;
  Facing facing = Facing::outward;
  /// Called as each step begins, with its name.
  std::function<void(std::string_view step)> progress = {};
};

struct PreparedSurface {
  Mesh mesh;
  std::optional<double> alpha;   ///< used: given or chosen; nothing for a given mesh
  std::optional<double> offset;  ///< used: of a wrap
  std::size_t holes = 0;         ///< of a given mesh that was to be filled
  std::size_t holes_filled = 0;
  double volume_before_smoothing = 0.0;  ///< signed, outward positive
  double volume = 0.0;                   ///< likewise, whatever the facing; before it is opened
  std::size_t parts_left_out = 0;        ///< at the opening
};

/// A chosen alpha is, for alpha shapes, the least at which the points become a filled solid with a manifold boundary;
/// for wraps the least of diagonal/20 * 2^(-k/2), k = 0 to 4, before the balls break through the input: until the
/// volume falls by more than 15 % or another handle or component appears. The diagonal is that of the bounding box.
/// Throws Error(input) for points that coincide, or lie in one plane where a solid is wanted, for a given mesh without
/// triangles, and for an opening that leaves nothing.
[[nodiscard]] PreparedSurface prepare_surface(const Mesh& input, const SurfaceOptions& options);

struct SurfaceCheck {
  MeshTopology topology;
  double volume = 0.0;   ///< signed: negative where the normals point inward
  std::size_t rims = 0;  ///< of an open surface that is manifold and oriented
  bool self_intersecting = false;
  double farthest_point = 0.0;  ///< the largest distance of an input point from the surface
};

/// Whether `surface` is what the commands that read it expect; of no points the farthest is at 0. Precondition: it has
/// triangles.
[[nodiscard]] SurfaceCheck check_surface(const Mesh& surface, std::span<const Point> points);

}  // namespace verisq
