/// Closed surfaces of clouds, damaged meshes and labelled volumes, and canals.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>
#include <verisq/files.hpp>
#include <verisq/mesh.hpp>
#include <verisq/mesh_topology.hpp>
#include <verisq/model.hpp>

namespace verisq {

// Prepares the surface of a bone or a cavity from a point cloud or a damaged mesh: the steps of the paper's Figure 4.
// Only in builds with CGAL, whose parts used here are under the GPL (CMake option VERISQ_SURFACE; link
// verisq::surface). All numbers are floating point: nothing here is an enclosure.

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
  /// How far the wrap keeps from the input; positive. Nothing: alpha / 100.
  std::optional<double> offset = std::nullopt;
  /// Whether to fill holes of a given mesh; the other methods leave none.
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

// The surface of a label of a segmented volume. Only in builds with CGAL, as `surface.hpp`. All numbers are floating
// point: nothing here is an enclosure, and nobody knows better than to about a voxel where the tissue ends.

struct LabelSurface {
  Mesh mesh;                       ///< closed, manifold, outward: of the label's parts the one of the largest area
  std::size_t parts_left_out = 0;  ///< other parts, and voids inside
  std::uint64_t voxels = 0;        ///< of the label
  /// Voxels of the label in the outermost layer of the volume, beyond which nobody looked: the surface is closed there.
  std::uint64_t voxels_at_border = 0;
};

/// Where the label's share of the neighbourhood is a half: the label as 1 and 0 is weighed with a Gaussian of 0.7
/// voxels along each axis of the volume, and the level surface is marched through tetrahedra between the voxels'
/// centres. A ball of radius r voxels shrinks by 0.5/r of a voxel; what is thinner than a voxel may be lost. Throws
/// Error(input) where no voxel has the label, or nothing of it is left.
[[nodiscard]] LabelSurface label_surface(const LabelVolume& volume, std::uint16_t label);

// The canal of a bone of which the outer surface and the thickness of the cortex are known. Only in builds with CGAL,
// as `surface.hpp`. All numbers are floating point: nothing here is an enclosure, and the thickness is what the caller
// says, not what the patient has.

/// How thick the cortex is at a height, the position along an axis.
struct ThicknessAtHeight {
  double height;
  double thickness;
};

/// Linear between heights, constant beyond the first and the last.
struct CorticalThickness {
  /// At least one; heights ascend, thicknesses are at least 0. Of a single one the height does not matter.
  std::vector<ThicknessAtHeight> at;
  Point axis{0.0, 0.0, 1.0};  ///< of any length but 0: a height is x . axis / |axis|

  [[nodiscard]] double operator()(const Point& x) const;
};

struct CanalOptions {
  CorticalThickness thickness;
  /// The distance of the samples, the size of what is not seen; nothing: a 200th of the longest side of the bone's box,
  /// or half of the least positive thickness where that is less. Positive.
  std::optional<double> spacing = std::nullopt;
};

struct Canal {
  Mesh mesh;                       ///< closed, manifold, outward
  double spacing;                  ///< used
  std::size_t parts_left_out = 0;  ///< where the bone is thinner than two cortices the canal falls apart
  std::size_t rims_closed = 0;     ///< of the bone
};

/// The points inside `bone` that are at least as far from its triangles as the cortex is thick at their height; of
/// several parts the one of the largest area. An open bone is closed over its rims first, and there the canal ends
/// without a cortex. Throws Error(input) where `bone` has no inside, or nothing is left of it.
[[nodiscard]] Canal canal_of(const Mesh& bone, const CanalOptions& options);

struct WallCheck {
  double least = 0.0;  ///< distance of a vertex of the canal from the bone's surface
  double mean = 0.0;
  double largest = 0.0;
  double largest_error = 0.0;  ///< of such a distance, to what the thickness asks for
};

/// Checks the vertices of `canal`, smoothed or not. Precondition: both have triangles.
[[nodiscard]] WallCheck check_wall(const Mesh& canal, const Mesh& bone, const CorticalThickness& thickness);

}  // namespace verisq
