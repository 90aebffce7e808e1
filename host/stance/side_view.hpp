/// Where the points of a body are that a picture from the side shows, proven.
#pragma once

#include <span>
#include <vector>
#include <verisq/stance_analysis.hpp>

#include "verify/stance/sagittal_model.hpp"

namespace verisq::stance {

/// In the world, m.
struct SidePoint {
  Enclosure x, y;
};

struct SideView {
  std::vector<SidePoint> origins;    ///< of the frames of all bodies: the joints that carry them
  std::vector<SidePoint> cylinders;  ///< middles of the axes of all cylinders
  SidePoint trunk;                   ///< the root's centre of mass
};

/// Contains all points for all parameters of the box and all joints within `positions` (of all joints, bodies in order,
/// m or rad). From these alone: a foot that the ground holds is no narrower here than the chain that leads to it.
[[nodiscard]] SideView side_view(const Model& model, UncertainSet uncertain, std::span<const Enclosure> positions);

/// Of all joints of the model, from those of its sagittal plane (SagittalModel::joints); the others are where the file
/// has them.
[[nodiscard]] std::vector<Enclosure> all_positions(const SagittalModel& sagittal, std::span<const Enclosure> positions);

}  // namespace verisq::stance
