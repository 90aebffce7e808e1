/// Where a cloud lies and how far it reaches: what the first shapes of a search are made of.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace verisq::recovery {

/// The points whose neighbourhoods are nearly as dense as most others': on a surface, not strewn about it. Compares all
/// pairs: for thousands of points at most.
[[nodiscard]] std::vector<Eigen::Vector3d> dense_points(std::span<const Eigen::Vector3d> points);

/// Principal axes as columns, right-handed, by ascending variance. Precondition: at least one point.
[[nodiscard]] Eigen::Matrix3d principal_axes(std::span<const Eigen::Vector3d> points);

/// A box that holds nearly all points, along the columns of `axes`.
struct OrientedBox {
  Eigen::Vector3d centre;
  Eigen::Vector3d half;  ///< positive
};

/// Leaves out one point in a hundred on each side. Precondition: at least one point.
[[nodiscard]] OrientedBox box_along(std::span<const Eigen::Vector3d> points, const Eigen::Matrix3d& axes);

}  // namespace verisq::recovery
