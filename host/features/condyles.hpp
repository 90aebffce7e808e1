/// The condyles of a femur: the points on which it lies, and its most prominent ones to both sides.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>
#include <verisq/mesh.hpp>

#include "host/features/shaft_axis.hpp"

namespace verisq::features {

struct Condyles {
  Eigen::Vector3d medial_posterior;
  Eigen::Vector3d lateral_posterior;
  Eigen::Vector3d medial_epicondyle;
  Eigen::Vector3d lateral_epicondyle;
};

/// The vertices beyond the shaft's distal end; none where the bone ends with its shaft.
[[nodiscard]] std::vector<Eigen::Vector3d> distal_end(const Mesh& mesh, const ShaftAxis& shaft);

/// How much farther the distal end reaches from the shaft's axis in a direction than against it: backward, for a femur.
[[nodiscard]] double excess(std::span<const Eigen::Vector3d> distal, const ShaftAxis& shaft,
                            const Eigen::Vector3d& direction);

/// `medial` and `posterior`: roughly those directions, across the shaft. Precondition: at least 10 vertices.
[[nodiscard]] Condyles condyles(std::span<const Eigen::Vector3d> distal, const ShaftAxis& shaft,
                                const Eigen::Vector3d& medial, const Eigen::Vector3d& posterior);

}  // namespace verisq::features
