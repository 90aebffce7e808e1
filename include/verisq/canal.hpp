/// The canal of a bone of which the outer surface and the thickness of the cortex are known. Only in builds with CGAL,
/// as `surface.hpp`. All numbers are floating point: nothing here is an enclosure, and the thickness is what the caller
/// says, not what the patient has.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>
#include <verisq/mesh.hpp>

namespace verisq {

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

/// Of the vertices of `canal`, smoothed or not. Precondition: both have triangles.
[[nodiscard]] WallCheck check_wall(const Mesh& canal, const Mesh& bone, const CorticalThickness& thickness);

}  // namespace verisq
