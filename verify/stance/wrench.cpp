/// Wrench and sensitivities as ranges of their components, and samples in plain floating point.
#include "verify/stance/parameters.hpp"
#include "verify/stance/rnea.hpp"
#include "verify/stance/wrench_component.hpp"

namespace verisq::stance {

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
