/// Weighted points in a tree of balls: bounds of sums over many points ask few of the balls.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace verisq::verify {

/// A point of the cavity and its weight.
struct WeightedPoint {
  Eigen::Vector3d place;
  double weight;  ///< >= 0
};

/// All points of a ball about their centre of mass: the sum of weight times (place - centre) is 0, but for roundings.
/// A leaf is one point, at the centre, of radius 0.
struct PointCluster {
  Eigen::Vector3d centre;
  double radius;         ///< rounded up
  double weight;         ///< of all, to nearest
  std::uint32_t second;  ///< index of the second child; the first follows its parent; 0: a leaf
};

/// The root is the first. Precondition: at least one point.
[[nodiscard]] std::vector<PointCluster> point_clusters(std::span<const WeightedPoint> points);

}  // namespace verisq::verify
