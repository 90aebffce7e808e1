/// The wrench on a free body.
#include <verisq/stance.hpp>

#include "verify/stance/equilibrium_location.hpp"
#include "verify/stance/rnea.hpp"
#include "verify/stance/tree.hpp"

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

namespace {

using verify::Interval;

using FirstOrder = Dual<Interval>;
using SecondOrder = Dual<FirstOrder>;

template <class T>
T component_at(const Model& model, const std::vector<T>& parameters, std::size_t component) {
  return root_wrench<T>(model, parameters, stance_state<T>(model))[component];
}

/// The wrench with its partial derivatives by one parameter.
FirstOrder expansion(const Model& model, std::size_t component, std::span<const Interval> box, std::uint32_t i) {
  return component_at(model, as_variables<1, Interval>(box, {i}), component);
}

/// Derivatives by parameter i of the derivative by parameter j.
Interval second_derivative(const Model& model, std::size_t component, std::span<const Interval> box, std::uint32_t i,
                           std::uint32_t j) {
  const std::vector<FirstOrder> inner = as_variables<1, Interval>(box, {i});
  const std::vector<SecondOrder> outer = as_variables<1, FirstOrder>(inner, {j});
  return component_at(model, outer, component).partial[0].partial[0];
}

}  // namespace

DifferentiableFunction wrench_component(const Model& model, std::size_t component) {
  return {[&model, component](std::span<const Interval> box) {
            return component_at(model, std::vector<Interval>(box.begin(), box.end()), component);
          },
          [&model, component](std::span<const Interval> box, std::uint32_t i) {
            return expansion(model, component, box, i).partial[0];
          }};
}

DifferentiableFunction wrench_derivative(const Model& model, std::size_t component, std::uint32_t parameter) {
  return {[&model, component, parameter](std::span<const Interval> box) {
            return expansion(model, component, box, parameter).partial[0];
          },
          [&model, component, parameter](std::span<const Interval> box, std::uint32_t i) {
            return second_derivative(model, component, box, i, parameter);
          }};
}

Box evaluation_box(const Model& model, UncertainSet uncertain, std::size_t component, Mode mode) {
  constexpr std::size_t moment_about_z = 5;
  Box box = parameter_box(model, uncertain);
  const std::optional<std::uint32_t> px = model.bodies.front().centre_of_mass[0].parameter;
  if (mode == Mode::paper && component == moment_about_z && px) box[*px] += box[*px] - box[*px];
  return box;
}

WrenchEnclosure wrench(const Model& model, UncertainSet uncertain, Mode mode) {
  WrenchEnclosure result;
  for (std::size_t k = 0; k < wrench_size; ++k) {
    result[k] = range(wrench_component(model, k), evaluation_box(model, uncertain, k, mode), uncertain);
  }
  return result;
}

WrenchEnclosure sensitivity(const Model& model, UncertainSet uncertain, std::uint32_t parameter, Mode mode) {
  WrenchEnclosure result;
  for (std::size_t k = 0; k < wrench_size; ++k) {
    result[k] = range(wrench_derivative(model, k, parameter), evaluation_box(model, uncertain, k, mode), uncertain);
  }
  return result;
}

std::array<double, wrench_size> sampled_wrench(const Model& model, std::span<const double> parameters) {
  return root_wrench<double>(model, parameters, stance_state<double>(model));
}

}  // namespace verisq::stance
