/// The equations of motion expanded about the middle of a cell, and their solution.
#include "verify/stance/acceleration_cell.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>

#include "verify/stance/acceleration_equations.hpp"

namespace verisq::stance {
namespace {

using verify::Interval;

using Variation = ParametricLinearSystem::Variation;

bool is_zero(const Variation& variation) {
  const auto zero = [](const Interval& a) { return a.lower() == 0.0 && a.upper() == 0.0; };
  return std::all_of(variation.matrix.reshaped().begin(), variation.matrix.reshaped().end(), zero) &&
         std::all_of(variation.residual.begin(), variation.residual.end(), zero);
}

/// Of the equations of motion by one parameter, over the box.
Variation variation(const Model& model, const Box& box, std::uint32_t variable, const Interval& deviation,
                    const Eigen::VectorXd& acceleration) {
  const std::vector<Dual<Interval>> parameters = as_variables<1, Interval>(box, {variable});
  const auto partial = [](const Dual<Interval>& a) { return a.partial[0]; };
  return {deviation, stance_mass_matrix(model, parameters).unaryExpr(partial),
          residual_force(model, parameters, acceleration).unaryExpr(partial)};
}

bool acts(const Model& model, const Box& box, std::uint32_t variable) {
  try {
    const auto size = static_cast<Eigen::Index>(model.degrees_of_freedom());
    return !is_zero(variation(model, box, variable, 0, Eigen::VectorXd::Zero(size)));
  } catch (const std::domain_error&) {
    // Numbers beyond binary64: nothing is proven.
    return true;
  }
}

}  // namespace

std::vector<double> middle_of(const Box& box) {
  std::vector<double> middle;
  middle.reserve(box.size());
  for (const Interval& side : box) {
    middle.push_back(std::clamp(0.5 * side.lower() + 0.5 * side.upper(), side.lower(), side.upper()));
  }
  return middle;
}

std::optional<ParametricSolution> accelerations_over(const Model& model, const Box& box,
                                                     std::span<const std::uint32_t> variables) {
  try {
    const std::vector<double> middle = middle_of(box);
    const Box centre(middle.begin(), middle.end());
    const Eigen::VectorXd near = approximate_accelerations(model, middle);
    ParametricLinearSystem system{near, stance_mass_matrix(model, centre), residual_force(model, centre, near), {}};
    for (const std::uint32_t i : variables) {
      system.variations.push_back(variation(model, box, i, box[i] - centre[i], near));
    }
    return solve(system);
  } catch (const std::domain_error&) {
    // Numbers beyond binary64: nothing is proven.
    return std::nullopt;
  }
}

std::vector<std::uint32_t> acting_parameters(const Model& model, const Box& box,
                                             std::span<const std::uint32_t> variables) {
  std::vector<std::uint32_t> acting;
  std::copy_if(variables.begin(), variables.end(), std::back_inserter(acting),
               [&](std::uint32_t i) { return acts(model, box, i); });
  return acting;
}

}  // namespace verisq::stance
