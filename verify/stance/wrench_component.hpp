/// One component of the wrench on the root, or one of its derivatives, as a differentiable function of the parameters.
#pragma once

#include <verisq/stance_analysis.hpp>

#include "verify/stance/mean_value_range.hpp"

namespace verisq::stance {

/// The model must outlive the function.
[[nodiscard]] DifferentiableFunction wrench_component(const Model& model, std::size_t component);

/// Its partial derivative by a parameter. The model must outlive the function.
[[nodiscard]] DifferentiableFunction wrench_derivative(const Model& model, std::size_t component,
                                                       std::uint32_t parameter);

/// Where the component is evaluated: in `tight` mode the box of the uncertain set. In `paper` mode the moment about z
/// (w6) sees the x of the root's centre of mass as px + (px - px), three times as wide as px: the printed cells are
/// those of g mp (0.05 + (px - px) - px) + c6 (docs/stance.md §1).
[[nodiscard]] Box evaluation_box(const Model& model, UncertainSet uncertain, std::size_t component, Mode mode);

}  // namespace verisq::stance
