/// Central differences over poses alone: sizes change none of the values.
#include "host/fit/pose_constraints.hpp"

#include <algorithm>
#include <cmath>

namespace verisq::fit_search {
namespace {

constexpr std::size_t pose_parameters = 6;
/// In parts of a change that moves the implant by one model unit: the values are smooth on that scale, and rounding is
/// far below it.
constexpr double step_share = 1e-4;

}  // namespace

PoseConstraints::PoseConstraints(const CandidateSpace& space, std::span<const FitConstraint> constraints,
                                 std::size_t implant)
    : space_(space), implant_(implant) {
  for (const FitConstraint& constraint : constraints) {
    if (std::isfinite(constraint.range.lo)) rows_.push_back({&constraint, false});
    if (std::isfinite(constraint.range.hi)) rows_.push_back({&constraint, true});
  }
}

std::vector<double> PoseConstraints::slack(std::span<const double> parameters) const {
  if (rows_.empty()) return {};
  const Pose pose = space_.pose(parameters);
  std::vector<double> slack;
  slack.reserve(rows_.size());
  const FitConstraint* known = nullptr;
  Enclosure value{};
  for (const auto& [constraint, upper] : rows_) {
    if (constraint != known) value = constraint->value(implant_, pose);
    known = constraint;
    slack.push_back((upper ? constraint->range.hi - value.hi : value.lo - constraint->range.lo) / constraint->unit);
  }
  return slack;
}

std::vector<double> PoseConstraints::jacobian(std::span<const double> parameters) const {
  std::vector<double> derivatives(rows_.size() * parameters.size());
  if (rows_.empty()) return derivatives;
  Parameters moved(parameters.begin(), parameters.end());
  for (std::size_t i = 0; i < pose_parameters; ++i) {
    const double step = step_share * space_.units()[i];
    moved[i] = parameters[i] + step;
    const std::vector<double> above = slack(moved);
    moved[i] = parameters[i] - step;
    const std::vector<double> below = slack(moved);
    moved[i] = parameters[i];
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      derivatives[k * parameters.size() + i] = (above[k] - below[k]) / (2.0 * step);
    }
  }
  return derivatives;
}

double PoseConstraints::violation(std::span<const double> parameters) const {
  double sum = 0.0;
  for (const double left : slack(parameters)) sum += std::max(-left, 0.0);
  return sum;
}

}  // namespace verisq::fit_search
