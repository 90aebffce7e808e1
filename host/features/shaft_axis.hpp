/// The axis of a femur's shaft, and where the shaft ends.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <verisq/mesh.hpp>

namespace verisq::features {

struct ShaftAxis {
  Eigen::Vector3d point;      ///< on the axis, in the middle of the shaft
  Eigen::Vector3d direction;  ///< of length 1, towards the head
  double distal;              ///< where the shaft ends, along the direction from the point
  double proximal;
  double area;         ///< of the narrowest section
  double distal_area;  ///< largest section between the shaft and the mesh's distal end
  double distal_end;   ///< where the mesh ends, along the direction from the point
};

/// By the centroids of sections across the axis, from `head` downward where the shaft is narrow. `along`: roughly the
/// axis, towards the head. Nothing where there are too few sections.
[[nodiscard]] std::optional<ShaftAxis> shaft_axis(const Mesh& mesh, const Eigen::Vector3d& head, double head_radius,
                                                  const Eigen::Vector3d& along);

}  // namespace verisq::features
