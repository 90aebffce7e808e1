/// Components of the root's wrench as functions of the parameters that can be differentiated twice.
#include "verify/stance/wrench_component.hpp"

#include "verify/stance/parameters.hpp"
#include "verify/stance/rnea.hpp"

namespace verisq::stance {
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

}  // namespace verisq::stance
