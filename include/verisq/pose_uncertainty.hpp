/// A model whose place is known within bounds only: what a tracking system or a registration leaves open.
#pragma once

#include <array>
#include <cmath>
#include <verisq/enclosure.hpp>
#include <verisq/mesh.hpp>

namespace verisq {

/// All poses x -> centre + E (x - centre) + d of what stands at its nominal pose: E any rotation about any axis by at
/// most `rotation`, |d[i]| <= translation[i].
struct PoseUncertainty {
  std::array<double, 3> translation{};  ///< along each axis, in model units; finite, at least 0
  double rotation = 0.0;                ///< in radians; finite, at least 0
  /// What the rotation leaves in place: in the coordinates of the points or triangles; of poses in the own ones of the
  /// model that they move.
  Point centre{};
};

/// Radians that are no less than the angle: for bounds that are known in degrees. Precondition: finite, at least 0.
[[nodiscard]] inline double radians_up(double degrees) {
  constexpr double above_pi_by_180 = 0x1.1df46a2529d3ap-6;  // the next binary64 number above it
  return std::nextafter(degrees * above_pi_by_180, infinity);
}

}  // namespace verisq
