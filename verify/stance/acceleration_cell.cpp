/// The equations of motion expanded about the middle of a cell, and their solution.
#include "verify/stance/acceleration_cell.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "verify/stance/acceleration_equations.hpp"

namespace verisq::stance {
namespace {

using verify::Interval;

using Variation = ParametricLinearSystem::Variation;

Interval slope_of(const Dual<Interval>& a) {
  return a.partial[0];
}

/// The equations of motion, whose unknowns are the accelerations alone.
struct WholeMotion {
  const Model& model;
  const Instant& at;

  [[nodiscard]] Eigen::Index unknowns() const { return static_cast<Eigen::Index>(model.degrees_of_freedom()); }

  template <class T>
  [[nodiscard]] Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic> matrix(const std::vector<T>& parameters) const {
    return mass_matrix_at(model, parameters, at);
  }

  template <class T>
  [[nodiscard]] Eigen::Matrix<T, Eigen::Dynamic, 1> residual(const std::vector<T>& parameters,
                                                             const Eigen::VectorXd& x) const {
    return residual_force(model, parameters, at, x);
  }
};

/// By one parameter, over the box.
template <class Motion>
Variation variation(const Motion& motion, const Box& box, std::uint32_t variable, const Interval& deviation,
                    const Eigen::VectorXd& x) {
  const std::vector<Dual<Interval>> parameters = as_variables<1, Interval>(box, {variable});
  return {deviation, motion.matrix(parameters).unaryExpr(&slope_of),
          motion.residual(parameters, x).unaryExpr(&slope_of)};
}

bool is_zero(const Variation& variation) {
  const auto zero = [](const Interval& a) { return a.lower() == 0.0 && a.upper() == 0.0; };
  return std::all_of(variation.matrix.reshaped().begin(), variation.matrix.reshaped().end(), zero) &&
         std::all_of(variation.residual.begin(), variation.residual.end(), zero);
}

bool acts(const Model& model, const Instant& at, const Box& box, std::uint32_t variable) {
  try {
    const WholeMotion motion{model, at};
    return !is_zero(variation(motion, box, variable, 0, Eigen::VectorXd::Zero(motion.unknowns())));
  } catch (const std::domain_error&) {
    // Numbers beyond binary64: nothing is proven.
    return true;
  }
}

std::optional<ReducedMotion> reduced_motion(const Model& model, const Instant& at, const Box& whole,
                                            std::span<const std::uint32_t> variables) {
  try {
    return ReducedMotion::of(model, at, variables, middle_of(whole));
  } catch (const std::domain_error&) {
    return std::nullopt;
  }
}

/// The accelerations are the first unknowns.
template <class Motion>
AccelerationCell examined(const Motion& motion, Eigen::Index count, const Box& box,
                          std::span<const std::uint32_t> variables) {
  const std::vector<double> middle = middle_of(box);
  const Box centre(middle.begin(), middle.end());
  ParametricLinearSystem system{{}, motion.matrix(centre), {}, {}};
  const auto number = [](const Interval& a) { return middle_of(a); };
  const IntervalVector right = motion.residual(centre, Eigen::VectorXd::Zero(motion.unknowns()));
  system.approximation = system.matrix.unaryExpr(number).partialPivLu().solve(right.unaryExpr(number));
  AccelerationCell cell{.accelerations = {}, .obstructions = {}, .sample = {}};
  cell.obstructions.assign(variables.size(), 0.0);
  if (!system.approximation.allFinite()) return cell;
  cell.sample = system.approximation.head(count);
  system.residual = motion.residual(centre, system.approximation);
  std::vector<std::size_t> moving;
  for (std::size_t k = 0; k < variables.size(); ++k) {
    const Interval& side = box[variables[k]];
    if (side.lower() == side.upper()) continue;
    moving.push_back(k);
    system.variations.push_back(
        variation(motion, box, variables[k], side - centre[variables[k]], system.approximation));
  }
  const std::optional<ParametricSolution> solved = solve(system);
  if (!solved) {
    const std::vector<double> found = obstructions(system);
    for (std::size_t n = 0; n < moving.size(); ++n) cell.obstructions[moving[n]] = found[n];
    return cell;
  }
  cell.accelerations = {solved->solution.head(count),
                        std::vector<IntervalVector>(variables.size(), IntervalVector::Zero(count))};
  for (std::size_t n = 0; n < moving.size(); ++n)
    cell.accelerations->derivatives[moving[n]] = solved->derivatives[n].head(count);
  return cell;
}

}  // namespace

AccelerationProblem::AccelerationProblem(const Model& model, const Instant& at, const Box& whole,
                                         UncertainSet uncertain)
    : model_(model), at_(at) {
  std::copy_if(uncertain.begin(), uncertain.end(), std::back_inserter(variables_),
               [&](std::uint32_t i) { return acts(model, at, whole, i); });
  reduced_ = reduced_motion(model, at, whole, variables_);
}

AccelerationCell AccelerationProblem::examine(const Box& box) const {
  const auto count = static_cast<Eigen::Index>(model_.degrees_of_freedom());
  try {
    if (reduced_) return examined(*reduced_, count, box, variables_);
    return examined(WholeMotion{model_, at_}, count, box, variables_);
  } catch (const std::domain_error&) {
    // Numbers beyond binary64: nothing is proven.
    return {.accelerations = {}, .obstructions = std::vector<double>(variables_.size(), 0.0), .sample = {}};
  }
}

}  // namespace verisq::stance
