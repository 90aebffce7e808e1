/// Poses of an implant that are moved off where its file places it, anywhere within reach.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <verisq/model.hpp>

#include "bench/uniform_numbers.hpp"
#include "verify/search/set_tree.hpp"

namespace verisq::bench {

/// About which a fit turns the implant.
[[nodiscard]] inline Eigen::Vector3d centre_of(const Model& implant) {
  const verify::Box box = verify::bounding_box(implant);
  return (Eigen::Vector3d(box.lower[0], box.lower[1], box.lower[2]) +
          Eigen::Vector3d(box.upper[0], box.upper[1], box.upper[2])) /
         2.0;
}

/// Moved by at most `reach` along each axis, and turned about the centre by a rotation vector of at most `degrees`
/// along each axis.
[[nodiscard]] inline Pose moved_off(const Eigen::Vector3d& centre, double reach, double degrees,
                                    UniformNumbers& uniform) {
  const auto anywhere = [&uniform](double limit) {
    const double x = uniform.within(limit);
    const double y = uniform.within(limit);
    return Eigen::Vector3d(x, y, uniform.within(limit));
  };
  const Eigen::Vector3d translation = anywhere(reach);
  const Eigen::Vector3d rotation = anywhere(degrees * std::numbers::pi / 180.0);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(rotation.norm(), rotation.stableNormalized()));
  const Eigen::Vector3d to = centre + translation - turn * centre;
  return {{to[0], to[1], to[2]}, {turn.w(), turn.x(), turn.y(), turn.z()}};
}

}  // namespace verisq::bench
