/// Where a picture is taken from.
#pragma once

#include <Eigen/Core>
#include <vector>
#include <verisq/mesh.hpp>

namespace verisq::report {

/// Turns, moves and scales points: x to the right, y up, z towards the viewer; bone and implant within [-1, 1]^3 (and
/// somewhat more, where turned).
struct View {
  Eigen::Matrix3d axes;  ///< rows: right, up, towards the viewer; a rotation
  Point centre;
  double half_size;

  [[nodiscard]] Eigen::Vector3d operator()(const Point& point) const {
    const Eigen::Vector3d moved(point[0] - centre[0], point[1] - centre[1], point[2] - centre[2]);
    return axes * (moved / half_size);
  }
};

/// The bone upright, that is its long axis, with the implant's end on top, and seen from where it is broadest.
[[nodiscard]] View broad_view(const Mesh& bone, const Mesh& implant);

/// The centroid of the triangles' area; of the vertices, where there is none.
[[nodiscard]] Eigen::Vector3d surface_centroid(const std::vector<Eigen::Vector3d>& vertices, const Mesh& mesh);

}  // namespace verisq::report
