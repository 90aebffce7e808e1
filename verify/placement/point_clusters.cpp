/// Centres of mass, and radii with room for roundings.
#include "verify/placement/point_clusters.hpp"

#include <algorithm>

#include "verify/placement/ball_tree.hpp"

namespace verisq::verify {

namespace {

using Eigen::Vector3d;

/// Room for the roundings of a distance, and for normals in binary32, which are a little longer than 1.
constexpr double kRoundedUp = 1.0 + 0x1p-20;

PointCluster cluster_of(std::span<const WeightedPoint> points) {
  double weight = 0.0;
  Vector3d sum = Vector3d::Zero();
  for (const WeightedPoint& point : points) {
    weight += point.weight;
    sum += point.weight * point.place;
  }
  const Vector3d centre = points.size() > 1 && weight > 0.0 ? Vector3d(sum / weight) : points.front().place;
  double radius = 0.0;
  for (const WeightedPoint& point : points) radius = std::max(radius, (point.place - centre).norm() * kRoundedUp);
  return {centre, radius, weight, 0};
}

}  // namespace

std::vector<PointCluster> point_clusters(std::span<const WeightedPoint> points) {
  return ball_tree<PointCluster>(points, cluster_of);
}

}  // namespace verisq::verify
