/// Krawczyk's operator for the balance of a standing body.
#include "verify/stance/equilibrium_location.hpp"

#include <Eigen/LU>
#include <cmath>
#include <utility>

#include "verify/stance/box_division.hpp"

namespace verisq::stance {
namespace {

using verify::Interval;

std::vector<Interval> exactly(const std::vector<double>& values) {
  return {values.begin(), values.end()};
}

std::vector<Interval> sum(const std::vector<double>& centre, const IntervalVector& errors) {
  std::vector<Interval> result = exactly(centre);
  for (std::size_t i = 0; i < result.size(); ++i) result[i] += errors[static_cast<Eigen::Index>(i)];
  return result;
}

}  // namespace

std::optional<BalanceExpansion> BalanceExpansion::about(const StandingProblem& problem, const Box& box,
                                                        std::vector<double> parameters, std::vector<double> posture) {
  BalanceExpansion at{.parameters = std::move(parameters), .posture = std::move(posture)};
  const auto size = static_cast<Eigen::Index>(at.posture.size());
  at.inverse =
      by_unknowns<double>(problem, at.parameters, at.posture, Extent::balance).topRows(size).partialPivLu().inverse();
  if (!at.inverse.allFinite()) return std::nullopt;
  const std::vector<Interval> posture_of_box = exactly(at.posture);
  at.values = components<Interval>(problem, exactly(at.parameters), posture_of_box, Extent::all);
  at.newton = -product(at.inverse, IntervalVector(at.values.head(size)));
  at.constant = at.newton;
  for (const std::uint32_t k : problem.parameters) {
    const bool exact = box[k].lower() == box[k].upper();  // no deviation, which its derivative would meet
    at.variation.push_back(exact ? IntervalVector::Zero(at.values.size())
                                 : by_parameter(problem, box, posture_of_box, k));
    if (exact) continue;
    at.constant -=
        product(at.inverse, IntervalVector(at.variation.back().head(size))) * (box[k] - Interval(at.parameters[k]));
  }
  return at;
}

IntervalMatrix BalanceExpansion::rest(const StandingProblem& problem, const Box& box,
                                      const std::vector<Interval>& unknowns) const {
  const auto size = static_cast<Eigen::Index>(posture.size());
  const IntervalMatrix slopes = by_unknowns<Interval>(problem, box, unknowns, Extent::balance).topRows(size);
  return IntervalMatrix::Identity(size, size) - product(inverse, slopes);
}

IntervalVector Located::ranges(const StandingProblem& problem, const Box& box) const {
  const BalanceExpansion& at = expansion;
  const auto size = static_cast<Eigen::Index>(at.posture.size());
  IntervalVector result = at.values + product(slopes, IntervalVector(at.newton + product(rest, errors)));
  for (std::size_t i = 0; i < problem.parameters.size(); ++i) {
    const std::uint32_t k = problem.parameters[i];
    const IntervalVector moved = product(at.inverse, IntervalVector(at.variation[i].head(size)));
    result += (at.variation[i] - product(slopes, moved)) * (box[k] - Interval(at.parameters[k]));
  }
  return result;
}

std::optional<IntervalVector> Located::posture_by(const StandingProblem& problem, const Box& box,
                                                  std::uint32_t parameter) const {
  const auto size = static_cast<Eigen::Index>(unknowns.size());
  const IntervalVector direct = by_parameter(problem, box, unknowns, parameter);
  return fixed_points(-product(expansion.inverse, IntervalVector(direct.head(size))), rest);
}

std::optional<Located> locate(const StandingProblem& problem, const Box& box) {
  constexpr int most_inflations = 12;
  constexpr int refinements = 3;
  std::vector<double> middle = middle_of(box);
  std::vector<double> posture = approximate_equilibrium(problem, middle);
  std::optional<BalanceExpansion> expansion =
      BalanceExpansion::about(problem, box, std::move(middle), std::move(posture));
  if (!expansion) return std::nullopt;
  Located at{.expansion = std::move(*expansion)};
  at.errors = at.expansion.constant;
  for (int i = 0; i < most_inflations; ++i) {
    const IntervalVector wide = inflated(at.errors);
    at.alone = sum(at.expansion.posture, wide);
    at.rest = at.expansion.rest(problem, box, at.alone);
    at.errors = at.expansion.constant + product(at.rest, wide);
    if (!in_interior(at.errors, wide)) continue;
    for (int k = 0; k < refinements; ++k) at.errors = at.expansion.constant + product(at.rest, at.errors);
    at.unknowns = sum(at.expansion.posture, at.errors);
    at.slopes = by_unknowns<Interval>(problem, box, at.unknowns, Extent::all);
    return at;
  }
  return std::nullopt;
}

std::optional<EquilibriumFunction> equilibrium_function(const StandingProblem& problem, const Box& box) {
  const std::optional<Located> at = locate(problem, box);
  if (!at) return std::nullopt;
  const auto points = static_cast<Eigen::Index>(points_of_cylinder * problem.model.cylinders.size());
  const IntervalVector ranges = at->ranges(problem, box);
  for (const Interval& penetration : ranges.segment(static_cast<Eigen::Index>(at->unknowns.size()), points)) {
    if (!(penetration.lower() > 0.0)) return std::nullopt;
  }
  Box centre = box;
  for (std::size_t i = 0; i < centre.size(); ++i) centre[i] = Interval(at->expansion.parameters[i]);
  const std::optional<Located> at_centre = locate(problem, centre);
  if (!at_centre || !lies_within(at_centre->unknowns, at->alone)) return std::nullopt;
  EquilibriumFunction result{at->expansion.parameters, at_centre->unknowns, at->unknowns, {}};
  for (const std::uint32_t k : problem.parameters) {
    std::optional<IntervalVector> derivative = at->posture_by(problem, box, k);
    if (!derivative) return std::nullopt;
    result.by_parameters.push_back(std::move(*derivative));
  }
  return result;
}

std::vector<double> approximate_equilibrium(const StandingProblem& problem, const std::vector<double>& parameters) {
  constexpr int most_steps = 30;
  constexpr double converged = 1e-15;
  std::vector<double> unknowns = problem.start;
  const auto size = static_cast<Eigen::Index>(unknowns.size());
  for (int step = 0; step < most_steps; ++step) {
    const Eigen::VectorXd missing = components<double>(problem, parameters, unknowns, Extent::balance).head(size);
    const Eigen::MatrixXd jacobian = by_unknowns<double>(problem, parameters, unknowns, Extent::balance).topRows(size);
    const Eigen::VectorXd change = jacobian.partialPivLu().solve(missing);
    if (!change.allFinite()) break;
    for (Eigen::Index i = 0; i < size; ++i) unknowns[static_cast<std::size_t>(i)] -= change[i];
    if (change.cwiseAbs().maxCoeff() <= converged) break;
  }
  return unknowns;
}

bool lies_within(const std::vector<Interval>& inner, const std::vector<Interval>& outer) {
  for (std::size_t i = 0; i < inner.size(); ++i) {
    if (!(inner[i].lower() >= outer[i].lower() && inner[i].upper() <= outer[i].upper())) return false;
  }
  return true;
}

}  // namespace verisq::stance
