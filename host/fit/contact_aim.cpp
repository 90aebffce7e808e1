/// A smooth step for each point, a smooth hinge for each end of a range.
#include "host/fit/contact_aim.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>

#include "host/fit/evaluation_sum.hpp"

namespace verisq::fit_search {
namespace {

constexpr double reach_in_scales = 0.1;
/// Of a share that is missing, in weights of all points: F gains at most one of them by giving up all contact.
constexpr double cost_in_weights = 20.0;
/// Shares by which an end is kept within its range, and over which the hinge bends.
constexpr double margin = 0.002;
constexpr double bend = 0.002;

struct ValueAndSlope {
  double value;
  double slope;
};

/// 1 below -1, 0 above 1.
ValueAndSlope step(double t) {
  if (t <= -1.0) return {1.0, 0.0};
  if (t >= 1.0) return {0.0, 0.0};
  return {0.5 - 0.75 * t + 0.25 * t * t * t, 0.75 * (t * t - 1.0)};
}

/// 0 up to 0, then a parabola, then a line of slope 1.
ValueAndSlope hinge(double missing) {
  if (missing <= 0.0) return {0.0, 0.0};
  if (missing >= bend) return {missing - 0.5 * bend, 1.0};
  return {missing * missing / (2.0 * bend), missing / bend};
}

}  // namespace

ContactAim::ContactAim(std::span<const FitContact> contacts, double scale, double weight,
                       const MakeEvaluator& make_evaluator)
    : reach_(reach_in_scales * scale), cost_(cost_in_weights * weight) {
  for (const FitContact& contact : contacts) {
    const Cavity sampled{contact.points, {{"contact", 1.0}}, std::vector<std::uint32_t>(contact.points.size(), 0)};
    contacts_.push_back({&contact, std::accumulate(contact.weights.begin(), contact.weights.end(), 0.0),
                         std::shared_ptr(make_evaluator(sampled))});
  }
}

ContactAim ContactAim::widened(double factor) const {
  ContactAim wide = *this;
  wide.reach_ *= factor;
  return wide;
}

double ContactAim::share(const Contact& contact, std::span<const PointDistance> distances) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < distances.size(); ++i)
    sum += contact.asked->weights[i] * step((distances[i].distance - contact.asked->distance) / reach_).value;
  return sum / contact.weight;
}

double ContactAim::add_to(Evaluation& evaluation, const Candidate& candidate) const {
  double apart = 0.0;
  std::vector<PointDistance> distances;
  for (const Contact& contact : contacts_) {
    contact.evaluator->distances(candidate, distances);
    const double reached = share(contact, distances);
    const auto& [lo, hi] = contact.asked->share;
    apart += std::max({lo - reached, reached - hi, 0.0});
    const ValueAndSlope below = lo > 0.0 ? hinge(lo + margin - reached) : ValueAndSlope{0.0, 0.0};
    const ValueAndSlope above = hi < 1.0 ? hinge(reached - (hi - margin)) : ValueAndSlope{0.0, 0.0};
    evaluation.objective -= cost_ * (below.value + above.value);
    const double by_share = cost_ * (below.slope - above.slope);
    if (by_share != 0.0) add_derivatives(evaluation, contact, by_share, candidate, distances);
  }
  return apart;
}

void ContactAim::add_derivatives(Evaluation& evaluation, const Contact& contact, double by_share,
                                 const Candidate& candidate, std::span<const PointDistance> distances) const {
  const FitContact& asked = *contact.asked;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    const PointDistance& at = distances[i];
    const double slope = step((at.distance - asked.distance) / reach_).slope / reach_;
    if (slope == 0.0) continue;
    const double by_distance = by_share * asked.weights[i] * slope / contact.weight;
    const auto by_pose = pose_gradient(asked.points[i], candidate.pivot, at.normal);
    for (std::size_t k = 0; k < by_pose.size(); ++k) evaluation.pose_gradient[k] += by_distance * by_pose[k];
    for (std::size_t axis = 0; axis < 3; ++axis)
      evaluation.size_gradient[at.primitive][axis] += by_distance * at.size_gradient[axis];
  }
}

}  // namespace verisq::fit_search
