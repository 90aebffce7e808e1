/// How much bone an implant takes away on its way in: the volume that it sweeps of the bone, proven.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>
#include <verisq/bone_side.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/model.hpp>
#include <verisq/removed_volume_certificate.hpp>

namespace verisq {

/// Largest width of the volume's enclosure that is usually asked for, divided by its lower end.
inline constexpr double usual_volume_tolerance = 0.02;

/// So little that nobody asks how much more exactly, however small the volume is: 1e-7 of the cube about the implant's
/// bounding sphere, in cubic model units.
[[nodiscard]] double negligible_volume(const Model& implant);

/// The work ends when the enclosure is at most as wide as one of both tolerances allows.
struct RemovedVolumeOptions {
  double relative_tolerance = usual_volume_tolerance;  ///< of the volume's lower end, >= 0
  double tolerance = 0.0;                              ///< in cubic model units, >= 0
  std::uint64_t most_cubes = std::uint64_t{1} << 21U;  ///< looked at, about: then the enclosure stays as it is
  std::function<bool()> interrupted = [] { return false; };
  std::function<void(const Enclosure& volume)> progress = [](const Enclosure&) {};
};

struct RemovedVolume {
  Enclosure volume;  ///< of all bone that lies in the implant at some time, in cubic model units
  bool within_tolerance = false;
  std::uint64_t cubes = 0;                ///< looked at
  std::vector<std::size_t> rims = {};     ///< of each surface, over which it was closed
  bool interrupted = false;               ///< what is told is proven all the same
  RemovedVolumeCertificate divided = {};  ///< the cubes of the search: certified_removed_volume.hpp
};

/// The implant, a union of convex primitives, moves by the poses after its primitives' own, between them as in
/// insertion.hpp. Throws Error(input) for another model, a path as there, options out of range, a surface as
/// check_surface_has_sides, a cavity beside the bone's outer surface, and where numbers overflow.
[[nodiscard]] RemovedVolume removed_volume(std::span<const Pose> path, const Model& implant, const BoneRegion& bone,
                                           const RemovedVolumeOptions& options);

}  // namespace verisq
