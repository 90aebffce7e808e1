/// Where a picture is taken from.
#pragma once

#include <Eigen/Core>
#include <optional>
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

/// Of length 1: `asked`, or the bone's long axis, towards the end that is the implant's. An implant in the middle third
/// has no end: then as positive as the axis goes, as scanners place bodies.
[[nodiscard]] Eigen::Vector3d upright(const Mesh& bone, const Mesh& implant, const std::optional<Point>& asked);

/// With `up` on top, and seen from where the bone is broadest. Precondition: `up` of length 1.
[[nodiscard]] View broad_view(const Mesh& bone, const Mesh& implant, const Eigen::Vector3d& up);

/// The centroid of the triangles' area; of the vertices, where there is none.
[[nodiscard]] Eigen::Vector3d surface_centroid(const std::vector<Eigen::Vector3d>& vertices, const Mesh& mesh);

}  // namespace verisq::report
