/// What comes close to an end of its range may be what ends the search.
#include "host/planning/fit_conditions.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "host/planning/fit_contacts.hpp"

namespace verisq::planning {
namespace {

constexpr double close_in_scales = 0.01;
constexpr double close_in_degrees = 0.01;
constexpr double close_in_percent = 0.5;

double close_to(ConditionUnit unit, const FitProblem& problem) {
  switch (unit) {
    case ConditionUnit::degrees: return close_in_degrees;
    case ConditionUnit::percent: return close_in_percent;
    default: return close_in_scales * problem.options.fitness.scale;
  }
}

/// What is proven to be broken does not end anything, nor does an end that no value can pass.
std::optional<RangeEnd> binding_end(const FitCondition& condition, const FitProblem& problem) {
  if (condition.kept == false) return std::nullopt;
  const bool is_share = condition.unit == ConditionUnit::percent;
  const double close = close_to(condition.unit, problem);
  if (!(is_share && condition.range->lo <= 0.0) && condition.value->lo - condition.range->lo <= close)
    return RangeEnd::lower;
  if (!(is_share && condition.range->hi >= 100.0) && condition.range->hi - condition.value->hi <= close)
    return RangeEnd::upper;
  return std::nullopt;
}

/// The bone is no nearer than minus the limit.
FitCondition condition_of_limit(const FitProblem& problem, const FitProof& proof) {
  const Clearance& clearance = proof.clearance;
  FitCondition condition{.name = std::string(limit_condition),
                         .unit = ConditionUnit::length,
                         .value = proof.surface ? proof.surface->smallest_distance : clearance.smallest_distance,
                         .range = Enclosure{0.0 - problem.options.penetration_limit, infinity}};
  const bool broken = clearance.proven_too_deep > 0 || (proof.surface && proof.surface->proven_too_deep > 0);
  const bool proven =
      clearance.proven_shallow == clearance.map.points && (!proof.surface || proof.surface->undecided == 0);
  if (broken || proven) condition.kept = !broken;
  condition.binds = binding_end(condition, problem);
  return condition;
}

std::vector<FitCondition> conditions_of_sides(const FitProblem& problem, const Fit& fit, const FitProof& proof) {
  std::vector<FitCondition> conditions;
  if (!proof.sides) return conditions;
  for (std::size_t k = 0; k < fit.model.primitives.size(); ++k) {
    if (problem.options.sides[fit.implant][k] == SurfaceSide::any) continue;
    FitCondition condition{.name = fmt::format("side of {}", name_of_primitive(fit.model, k))};
    const SideFinding finding = proof.sides->of_primitives[k];
    if (finding == SideFinding::kept) condition.kept = true;
    if (finding == SideFinding::other_side) condition.kept = false;
    conditions.push_back(std::move(condition));
  }
  return conditions;
}

/// Of shares in percent, rounded outward by far more than 100 x is off.
Enclosure in_percent(const Enclosure& share) {
  constexpr double rounding = 1e-13;
  return {std::max(0.0, 100.0 * share.lo - rounding), std::min(100.0, 100.0 * share.hi + rounding)};
}

std::vector<FitCondition> conditions_of_contact(const FitProblem& problem, const FitProof& proof) {
  std::vector<FitCondition> conditions;
  for (const KeptFeature& kept : problem.contacts) {
    const Enclosure value = in_percent(*share_named(problem, *proof.contact, kept.name));
    FitCondition condition{.name = kept.name,
                           .unit = ConditionUnit::percent,
                           .value = value,
                           .range = kept.range,
                           .kept = is_within(value, kept.range)};
    condition.binds = binding_end(condition, problem);
    conditions.push_back(std::move(condition));
  }
  return conditions;
}

}  // namespace

std::vector<FitCondition> conditions_of_changes(const FitProblem& problem, const FemurFeatures& changes) {
  std::vector<FitCondition> conditions;
  for (const KeptFeature& kept : problem.kept) {
    const auto change = std::ranges::find(changes.features, kept.name, &Feature::name);
    FitCondition condition{.name = kept.name};
    if (change != changes.features.end()) {
      condition.unit = change->unit == FeatureUnit::degrees ? ConditionUnit::degrees : ConditionUnit::length;
      condition.value = change->value;
      condition.range = kept.range;
      condition.kept = is_within(change->value, kept.range);
      condition.binds = binding_end(condition, problem);
    }
    conditions.push_back(std::move(condition));
  }
  return conditions;
}

std::vector<FitCondition> conditions_of(const FitProblem& problem, const Fit& fit, const FitProof& proof) {
  std::vector<FitCondition> conditions{condition_of_limit(problem, proof)};
  const auto add = [&conditions](std::vector<FitCondition> more) {
    conditions.insert(conditions.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  };
  add(conditions_of_sides(problem, fit, proof));
  add(conditions_of_changes(problem, proof.changes));
  add(conditions_of_contact(problem, proof));
  return conditions;
}

}  // namespace verisq::planning
