/// Counts of neighbours, moments and percentiles.
#include "host/recovery/cloud_frame.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cstddef>

#include "host/recovery/weighted_sums.hpp"

namespace verisq::recovery {
namespace {

constexpr std::size_t neighbours = 9;  // in a neighbourhood of the middle size
constexpr std::size_t probes = 40;     // that size is measured at
constexpr double least_density = 0.4;  // of that which three quarters of the points keep below
constexpr double left_out = 0.01;      // on each side of a box
constexpr double least_half = 1e-12;   // of a box, of its largest

/// Squared; a neighbourhood of this radius holds `neighbours` points, in the middle.
double squared_radius(std::span<const Eigen::Vector3d> points) {
  const auto rank = static_cast<std::ptrdiff_t>(std::min(points.size() - 1, neighbours));
  std::vector<double> distances(points.size());
  std::vector<double> radii;
  for (std::size_t i = 0; i < std::min(points.size(), probes); ++i) {
    for (std::size_t j = 0; j < points.size(); ++j) distances[j] = (points[i] - points[j]).squaredNorm();
    std::nth_element(distances.begin(), distances.begin() + rank, distances.end());
    radii.push_back(distances[static_cast<std::size_t>(rank)]);
  }
  const auto middle = static_cast<std::ptrdiff_t>(radii.size() / 2);
  std::nth_element(radii.begin(), radii.begin() + middle, radii.end());
  return radii[static_cast<std::size_t>(middle)];
}

}  // namespace

std::vector<Eigen::Vector3d> dense_points(std::span<const Eigen::Vector3d> points) {
  const double limit = squared_radius(points);
  const std::vector<std::int64_t> counts = counts_within(points, limit);
  std::vector<std::int64_t> sorted = counts;
  const std::size_t rank = sorted.size() * 3 / 4;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(rank), sorted.end());
  std::vector<Eigen::Vector3d> dense;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (static_cast<double>(counts[i]) >= least_density * static_cast<double>(sorted[rank])) dense.push_back(points[i]);
  return dense;
}

Eigen::Matrix3d principal_axes(std::span<const Eigen::Vector3d> points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) mean += point;
  mean /= static_cast<double>(points.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& point : points) covariance += (point - mean) * (point - mean).transpose();
  Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors();
  if (axes.determinant() < 0.0) axes.col(2) *= -1.0;
  return axes;
}

OrientedBox box_along(std::span<const Eigen::Vector3d> points, const Eigen::Matrix3d& axes) {
  std::vector<double> along(points.size());
  const auto drop = static_cast<std::size_t>(left_out * static_cast<double>(points.size()));
  OrientedBox box{};
  for (int i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < points.size(); ++k) along[k] = axes.col(i).dot(points[k]);
    const std::size_t last = along.size() - 1 - drop;
    std::nth_element(along.begin(), along.begin() + static_cast<std::ptrdiff_t>(drop), along.end());
    const double lowest = along[drop];
    std::nth_element(along.begin(), along.begin() + static_cast<std::ptrdiff_t>(last), along.end());
    box.centre[i] = 0.5 * (lowest + along[last]);
    box.half[i] = 0.5 * (along[last] - lowest);
  }
  box.centre = axes * box.centre;
  box.half = box.half.cwiseMax(std::max(least_half * box.half.maxCoeff(), 1e-300));
  return box;
}

}  // namespace verisq::recovery
