/// All partial derivatives of a system of equations of motion, a few at a time.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "verify/stance/dual.hpp"
#include "verify/stance/motion_regime.hpp"

namespace verisq::stance {

/// M(state) a + ... = 0 for the rates a of the first `implicit()` components of the state, explicit rates of the
/// others:
///   std::size_t size() const, implicit() const, deviations() const;
///   template <class T> auto evaluate(std::span<const T> state, std::span<const T> a, const T& time,
///                                    const MotionRegime& regime, std::span<const T> deviations) const;  // .residual,
///                                    .rates
/// `residual` is affine in a, and all is Lipschitz continuous wherever it is evaluated.

/// A point, or a set of points, at which to evaluate it.
template <class T>
struct MotionPoint {
  std::vector<T> state, acceleration;
  T time;
  MotionRegime regime;
  std::vector<T> deviations;
};

/// Columns of derivatives: of the residual, then of the explicit rates.
template <class T>
using Columns = std::vector<std::vector<T>>;

/// By the variables `first` to before `last` of state, acceleration and deviations in this order.
template <class T, class System>
[[nodiscard]] Columns<T> partial_derivatives(const System& system, const MotionPoint<T>& at, std::size_t first,
                                             std::size_t last) {
  constexpr std::size_t at_once = 10;
  using Variable = Dual<T, at_once>;
  Columns<T> columns;
  for (std::size_t begin = first; begin < last; begin += at_once) {
    const std::size_t count = std::min(at_once, last - begin);
    std::size_t index = 0;
    const auto variables = [&](const std::vector<T>& values) {
      std::vector<Variable> result(values.begin(), values.end());
      for (Variable& variable : result) {
        if (index >= begin && index < begin + count) variable.partial[index - begin] = T(1);
        ++index;
      }
      return result;
    };
    const std::vector<Variable> state = variables(at.state);
    const std::vector<Variable> acceleration = variables(at.acceleration);
    const std::vector<Variable> deviations = variables(at.deviations);
    const auto terms =
        system.template evaluate<Variable>(state, acceleration, Variable(at.time), at.regime, deviations);
    for (std::size_t k = 0; k < count; ++k) {
      std::vector<T> column;
      for (const Variable& value : terms.residual) column.push_back(value.partial[k]);
      for (const Variable& value : terms.rates) column.push_back(value.partial[k]);
      columns.push_back(std::move(column));
    }
  }
  return columns;
}

}  // namespace verisq::stance
