/// The surface of a label of a segmented volume. Only in builds with CGAL, as `surface.hpp`. All numbers are floating
/// point: nothing here is an enclosure, and nobody knows better than to about a voxel where the tissue ends.
#pragma once

#include <cstddef>
#include <cstdint>
#include <verisq/label_volume.hpp>
#include <verisq/mesh.hpp>

namespace verisq {

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

}  // namespace verisq
