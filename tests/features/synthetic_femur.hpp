/// Femora whose features are known exactly: spheres, capsules and ellipsoids, as a closed mesh whose vertices lie on
/// them.
#pragma once

#include <Eigen/Geometry>
#include <verisq/features.hpp>
#include <verisq/mesh.hpp>

namespace verisq {

/// In the ISB's directions of a right femur: x ahead, y up, z to the right; a left one is its mirror image.
struct SyntheticFemur {
  double head_radius = 24.0;
  double ccd_degrees = 127.0;
  double version_degrees = 14.0;  ///< against the posterior condylar line, seen along the shaft
  double neck_length = 52.0;      ///< from the shaft's axis to the head's centre
  double shaft_length = 170.0;
  bool condyles = true;
  bool ridge = false;  ///< ahead of the lateral condyle's middle, and 2 mm farther out

  [[nodiscard]] Eigen::Vector3d head_centre() const;
  [[nodiscard]] double offset() const;  ///< of the head's centre from the shaft's axis, the line x = z = 0
};

/// Closed and outward, of cells `step` mm wide.
[[nodiscard]] Mesh mesh_of(const SyntheticFemur& femur, Side side, double step);

}  // namespace verisq
