/// Sums of fitness values and slopes.
#include "host/fit/evaluation_sum.hpp"

#include <algorithm>
#include <cmath>

#include "verisq/enclosure.hpp"

namespace verisq::fit_search {

namespace {

/// f rises to its target and falls beyond it: over [d - r, d + r] it is largest nearest to the target.
double largest_value(const Fitness& fitness, double distance, double radius) {
  return value(fitness, std::clamp(fitness.target, distance - radius, distance + radius));
}

}  // namespace

std::array<double, 6> pose_gradient(const Point& point, const Point& pivot, const Point& normal) {
  const auto& [nx, ny, nz] = normal;
  const double x = point[0] - pivot[0];
  const double y = point[1] - pivot[1];
  const double z = point[2] - pivot[2];
  return {-nx, -ny, -nz, z * ny - y * nz, x * nz - z * nx, y * nx - x * ny};
}

EvaluationSum::EvaluationSum(const Fitness& fitness, const Candidate& candidate, const PoseCell& cell)
    : fitness_(fitness),
      pivot_(candidate.pivot),
      cell_(cell),
      sum_{.objective = 0.0,
           .pose_gradient = {},
           .size_gradient = std::vector<std::array<double, 3>>(candidate.primitives.size()),
           .smallest_distance = infinity,
           .objective_bound = 0.0} {}

void EvaluationSum::add(const Point& point, double weight, const PointDistance& at) {
  sum_.objective += weight * value(fitness_, at.distance);
  sum_.smallest_distance = std::min(sum_.smallest_distance, at.distance);
  const double by_distance = weight * slope(fitness_, at.distance);
  const std::array<double, 6> by_pose = fit_search::pose_gradient(point, pivot_, at.normal);
  for (std::size_t i = 0; i < 6; ++i) sum_.pose_gradient[i] += by_distance * by_pose[i];
  for (std::size_t i = 0; i < 3; ++i) sum_.size_gradient[at.primitive][i] += by_distance * at.size_gradient[i];
  const double lever = std::hypot(point[0] - pivot_[0], point[1] - pivot_[1], point[2] - pivot_[2]);
  sum_.objective_bound += weight * largest_value(fitness_, at.distance, cell_.translation + cell_.rotation * lever);
}

void EvaluationSum::add(const EvaluationSum& other) {
  sum_.objective += other.sum_.objective;
  sum_.smallest_distance = std::min(sum_.smallest_distance, other.sum_.smallest_distance);
  sum_.objective_bound += other.sum_.objective_bound;
  for (std::size_t i = 0; i < 6; ++i) sum_.pose_gradient[i] += other.sum_.pose_gradient[i];
  for (std::size_t k = 0; k < sum_.size_gradient.size(); ++k)
    for (std::size_t i = 0; i < 3; ++i) sum_.size_gradient[k][i] += other.sum_.size_gradient[k][i];
}

}  // namespace verisq::fit_search
