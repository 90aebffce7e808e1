/// The neck of a femur: its narrowest section.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <verisq/mesh.hpp>

namespace verisq::features {

struct NeckSection {
  Eigen::Vector3d centre;  ///< centroid of the section of least perimeter
  double perimeter;
  double distance;  ///< from the head's centre
};

/// Of the sections by planes that look at the head's centre. `towards_shaft`: roughly the neck, from the head, of
/// length
/// 1. Nothing where no plane cuts the neck in one closed curve.
[[nodiscard]] std::optional<NeckSection> neck_section(const Mesh& mesh, const Eigen::Vector3d& head, double head_radius,
                                                      const Eigen::Vector3d& towards_shaft);

}  // namespace verisq::features
