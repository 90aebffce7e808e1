/// Boxes of parameters, divided, and where equilibria lie in them.
#include "verify/stance/equilibrium_location.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <queue>
#include <stdexcept>
#include <utility>

#include "verisq/enclosure.hpp"

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

namespace {

using verify::Interval;

struct Cell {
  Box box;
  double bound;          ///< of the function's values over the box, from above
  bool final;            ///< whether bisection would win no more than rounding errors
  std::uint32_t widest;  ///< the variable whose halving promises most

  [[nodiscard]] bool operator<(const Cell& other) const { return bound < other.bound; }
};

/// The point x that makes the upper end of f(c) + d (x - c) over x in `range` least, for an increasing f with the upper
/// end, for a decreasing one the lower end, and between them in proportion (Baumann 1988). Any point is sound.
double best_centre(const Interval& range, const Interval& derivative) {
  if (derivative.lower() >= 0.0) return range.upper();
  if (derivative.upper() <= 0.0) return range.lower();
  const double share = derivative.upper() / (derivative.upper() - derivative.lower());
  if (!std::isfinite(share)) return range.lower();
  return std::clamp(range.lower() + share * (range.upper() - range.lower()), range.lower(), range.upper());
}

/// Bisection for the greatest value of a function over a box.
class Maximum {
 public:
  Maximum(const DifferentiableFunction& function, std::span<const std::uint32_t> variables)
      : function_(function), variables_(variables) {}

  [[nodiscard]] double above(const Box& box) {
    constexpr int most_bisections = 2000;
    constexpr double tolerance = 1e-12;
    std::priority_queue<Cell> cells;
    cells.push(bounded(box));
    for (int i = 0; i < most_bisections; ++i) {
      const Cell worst = cells.top();
      if (worst.final || worst.bound - reached_ <= tolerance * std::fabs(worst.bound)) break;
      const Interval side = worst.box[worst.widest];
      const double middle = 0.5 * side.lower() + 0.5 * side.upper();
      if (!(side.lower() < middle && middle < side.upper())) break;
      cells.pop();
      for (const Interval& half : {Interval(side.lower(), middle), Interval(middle, side.upper())}) {
        Box part = worst.box;
        part[worst.widest] = half;
        Cell cell = bounded(part);
        // Both bounds hold for the part.
        cell.bound = std::fmin(cell.bound, worst.bound);
        cells.push(std::move(cell));
      }
    }
    return cells.top().bound;
  }

 private:
  /// f(x) = f(c) + sum of d_i (x_i - c_i) with derivatives d_i between c and x: for c in the box, in its gradient.
  [[nodiscard]] Cell bounded(const Box& box) {
    Box centre = box;
    Interval slope = 0;
    Cell cell{box, function_.value(box).upper(), true, 0};
    double most = 0.0;
    for (const std::uint32_t i : variables_) {
      const Interval derivative = function_.partial(box, i);
      centre[i] = best_centre(box[i], derivative);
      slope += derivative * (box[i] - centre[i]);
      const double gain = (derivative * (box[i] - centre[i])).upper();
      if (gain > most) {
        most = gain;
        cell.widest = i;
      }
    }
    const Interval at_centre = function_.value(centre);
    reached_ = std::fmax(reached_, at_centre.lower());
    cell.final = slope.upper() <= at_centre.upper() - at_centre.lower();
    cell.bound = std::fmin(cell.bound, (at_centre + slope).upper());
    return cell;
  }

  const DifferentiableFunction& function_;
  std::span<const std::uint32_t> variables_;
  double reached_ = -infinity;
};

}  // namespace

Enclosure range(const DifferentiableFunction& function, const Box& box, std::span<const std::uint32_t> variables) {
  const DifferentiableFunction negative{
      [&](std::span<const Interval> x) { return -function.value(x); },
      [&](std::span<const Interval> x, std::uint32_t i) { return -function.partial(x, i); }};
  try {
    // Plus 0: no negative zeros in tables.
    return {0.0 - Maximum(negative, variables).above(box), 0.0 + Maximum(function, variables).above(box)};
  } catch (const std::domain_error&) {
    // Numbers beyond binary64: nothing is proven.
    return {-infinity, infinity};
  }
}

}  // namespace verisq::stance
