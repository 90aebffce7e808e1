/// A smooth step for each point.
#include "host/fit/contact_constraints.hpp"

#include <algorithm>
#include <numeric>

#include "host/fit/evaluation_sum.hpp"

namespace verisq::fit_search {
namespace {

constexpr double reach_in_scales = 0.1;
constexpr double shares_per_unit = 10.0;

/// 1 below -1, 0 above 1, with a continuous slope: 3/4 in the middle.
struct Step {
  double value;
  double slope;
};
Step step(double t) {
  if (t <= -1.0) return {1.0, 0.0};
  if (t >= 1.0) return {0.0, 0.0};
  return {0.5 - 0.75 * t + 0.25 * t * t * t, 0.75 * (t * t - 1.0)};
}

}  // namespace

ContactConstraints::ContactConstraints(std::span<const FitContact> contacts, double scale)
    : reach_(reach_in_scales * scale) {
  for (const FitContact& contact : contacts) {
    const double weight = std::accumulate(contact.weights.begin(), contact.weights.end(), 0.0);
    if (!(weight > 0.0)) continue;
    if (contact.share.lo > 0.0) rows_.push_back({&contact, false, weight});
    if (contact.share.hi < 1.0) rows_.push_back({&contact, true, weight});
  }
}

std::vector<double> ContactConstraints::slack(std::span<const PointDistance> distances) const {
  std::vector<double> slack;
  slack.reserve(rows_.size());
  for (const auto& [contact, upper, weight] : rows_) {
    double sum = 0.0;
    for (std::size_t i = 0; i < contact->weights.size(); ++i)
      sum += contact->weights[i] * step((distances[i].distance - contact->distance) / reach_).value;
    const double share = sum / weight;
    slack.push_back(shares_per_unit * (upper ? contact->share.hi - share : share - contact->share.lo));
  }
  return slack;
}

double ContactConstraints::violation(std::span<const PointDistance> distances) const {
  double sum = 0.0;
  for (const double left : slack(distances)) sum += std::max(-left, 0.0);
  return sum;
}

void ContactConstraints::write_jacobian(const CandidateSpace& space, std::span<const double> parameters,
                                        std::span<const Point> points, std::span<const PointDistance> distances,
                                        std::span<double> jacobian) const {
  std::ranges::fill(jacobian, 0.0);
  std::vector<double> of_point(parameters.size());
  const Point pivot = space.pivot(parameters);
  for (std::size_t j = 0; j < rows_.size(); ++j) {
    const auto& [contact, upper, weight] = rows_[j];
    const std::span<double> row = jacobian.subspan(j * parameters.size(), parameters.size());
    for (std::size_t i = 0; i < contact->weights.size(); ++i) {
      const double slope = step((distances[i].distance - contact->distance) / reach_).slope;
      if (slope == 0.0 || contact->weights[i] == 0.0) continue;
      space.gradient(parameters, pose_gradient(points[i], pivot, distances[i].normal), distances[i], of_point);
      const double factor = (upper ? -1.0 : 1.0) * shares_per_unit * contact->weights[i] * slope / (reach_ * weight);
      for (std::size_t k = 0; k < row.size(); ++k) row[k] += factor * of_point[k];
    }
  }
}

}  // namespace verisq::fit_search
