/// A picture of what is proven over a box of two parameters, cell by cell.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>
#include <verisq/stance_equilibrium.hpp>
#include <verisq/stance_model.hpp>
#include <verisq/stance_stability.hpp>

namespace verisq::stance {

/// SVG: the first parameter to the right, the second upward. Preconditions: cells of two uncertain parameters, these
/// two, at least one.
[[nodiscard]] std::string parameter_map(std::span<const EquilibriumCell> cells, const std::array<Parameter, 2>& axes);
[[nodiscard]] std::string parameter_map(std::span<const StabilityCell> cells, const std::array<Parameter, 2>& axes);

}  // namespace verisq::stance
