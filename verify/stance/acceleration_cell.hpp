/// All joint accelerations over a box of parameters, by the parametric linear system of the equations of motion.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>
#include <verisq/stance_model.hpp>

#include "verify/stance/linear_system.hpp"
#include "verify/stance/mean_value_range.hpp"

namespace verisq::stance {

/// A point of the box, near its middle.
[[nodiscard]] std::vector<double> middle_of(const Box& box);

/// The accelerations at every point of the box, which vary by `variables`: the box's coordinates that are not points,
/// or those of them that act. Nothing where it is not proven that every mass matrix is regular.
[[nodiscard]] std::optional<ParametricSolution> accelerations_over(const Model& model, const Box& box,
                                                                   std::span<const std::uint32_t> variables);

/// Those of `variables` by which the equations of motion may change over the box; for all others the derivative is
/// proven to be 0.
[[nodiscard]] std::vector<std::uint32_t> acting_parameters(const Model& model, const Box& box,
                                                           std::span<const std::uint32_t> variables);

}  // namespace verisq::stance
