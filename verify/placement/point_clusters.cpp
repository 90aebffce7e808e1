/// Halves along the longest direction.
#include "verify/placement/point_clusters.hpp"

#include <algorithm>

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

void add_clusters(std::span<WeightedPoint> points, std::vector<PointCluster>& clusters) {
  const std::size_t own = clusters.size();
  clusters.push_back(cluster_of(points));
  if (points.size() == 1) return;
  Vector3d lower = points.front().place;
  Vector3d upper = lower;
  for (const WeightedPoint& point : points) {
    lower = lower.cwiseMin(point.place);
    upper = upper.cwiseMax(point.place);
  }
  Eigen::Index longest = 0;
  (upper - lower).maxCoeff(&longest);
  const std::size_t half = points.size() / 2;
  std::ranges::nth_element(points, points.begin() + static_cast<std::ptrdiff_t>(half), {},
                           [longest](const WeightedPoint& point) { return point.place[longest]; });
  add_clusters(points.first(half), clusters);
  clusters[own].second = static_cast<std::uint32_t>(clusters.size());
  add_clusters(points.subspan(half), clusters);
}

}  // namespace

std::vector<PointCluster> point_clusters(std::span<const WeightedPoint> points) {
  std::vector<WeightedPoint> sorted(points.begin(), points.end());
  std::vector<PointCluster> clusters;
  clusters.reserve(2 * points.size());
  add_clusters(sorted, clusters);
  return clusters;
}

}  // namespace verisq::verify
