/// Values of a stance model's parameters: nominal, over the box of an uncertain set, and as variables to differentiate
/// by.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>
#include <verisq/stance_analysis.hpp>

#include "verify/numbers/interval.hpp"
#include "verify/stance/dual.hpp"

namespace verisq::stance {

/// The parameter's value where `quantity` is a parameter, and the nominal number elsewhere.
template <class T>
[[nodiscard]] T value_of(const Quantity& quantity, std::span<const T> parameters) {
  return quantity.parameter ? parameters[*quantity.parameter] : T(quantity.nominal);
}

/// As many as the model has parameters, in their order.
template <class T>
[[nodiscard]] std::vector<T> nominal_parameters(const Model& model) {
  std::vector<T> values;
  values.reserve(model.parameters.size());
  for (const Parameter& parameter : model.parameters) values.push_back(T(parameter.nominal));
  return values;
}

/// The whole range of each uncertain parameter, the nominal value of all others.
[[nodiscard]] inline std::vector<verify::Interval> parameter_box(const Model& model, UncertainSet uncertain) {
  std::vector<verify::Interval> box = nominal_parameters<verify::Interval>(model);
  for (const std::uint32_t i : uncertain) {
    const Enclosure& range = model.parameters[i].range;
    box[i] = verify::Interval(range.lo, range.hi);
  }
  return box;
}

/// The values, as functions of N of themselves: partial derivative k is by the parameter variables[k].
template <std::size_t N, class T>
[[nodiscard]] std::vector<Dual<T, N>> as_variables(std::span<const T> values,
                                                   const std::array<std::uint32_t, N>& variables) {
  std::vector<Dual<T, N>> result(values.begin(), values.end());
  for (std::size_t k = 0; k < N; ++k) result[variables[k]].partial[k] = T(1);
  return result;
}

}  // namespace verisq::stance
