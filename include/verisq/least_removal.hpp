/// The way in that takes the least bone away: the best of many straight or turning ways that are tried.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>
#include <verisq/enclosure.hpp>
#include <verisq/insertion.hpp>
#include <verisq/model.hpp>
#include <verisq/removed_volume.hpp>

namespace verisq {

/// Ways into one last pose, from a middle one: directions that are off its direction by no more than an angle, turns
/// that differ from its turn by no more than another.
struct WaysIn {
  WayIn middle;
  double cone_degrees = 0.0;  ///< in [0, 80]
  double turn_degrees = 0.0;  ///< in [0, 180]
};

struct LeastRemovalProgress {
  std::size_t tried;
  std::size_t ways;  ///< to be tried in all
  Enclosure least;   ///< volume of the best one so far
};

struct LeastRemovalOptions {
  RemovedVolumeOptions volume;  ///< of the chosen way; its progress is not asked
  /// Ways are compared by the upper ends of volumes no wider than this share of their lower ends, or than `volume` asks
  /// for, where a moderate number of cubes allows it.
  double relative_tolerance = 0.05;
  std::function<void(const LeastRemovalProgress&)> progress = [](const LeastRemovalProgress&) {};
};

struct LeastRemoval {
  WayIn way;
  std::vector<Pose> path;    ///< of it
  RemovedVolume removed;     ///< of it, as closely as asked for: proven
  Enclosure of_middle;       ///< what the middle way takes away: proven, as closely as ways were compared
  std::size_t tried = 0;     ///< ways, the middle one among them
  std::size_t worse = 0;     ///< of them, proven to take away more than the chosen one
  bool interrupted = false;  ///< before all ways were tried, or the volume was as narrow as asked for
};

/// Tries ways that are spread over all of the family, then ever closer about the best one; each is given up as soon as
/// it is proven to take more away than the best. The volumes are proven, that there is no better way is not. The
/// implant ends where its model has it, and turns about an axis through `centre`. Throws Error(input) for angles out of
/// their ranges, where both are 0, and as path_of and removed_volume.
[[nodiscard]] LeastRemoval least_removal(const WaysIn& ways, const Point& centre, const Model& implant,
                                         const BoneRegion& bone, const LeastRemovalOptions& options);

}  // namespace verisq
