/// The paper's sum over |sensitivity| times parameter, and the radius form.
#include <verisq/stance_analysis.hpp>

#include "verify/numbers/interval.hpp"

namespace verisq::stance {
namespace {

using verify::Interval;

/// Half of the range's width.
Interval radius(const Enclosure& range) {
  return (Interval(range.hi) - Interval(range.lo)) / Interval(2);
}

}  // namespace

ReferenceUncertainty reference_uncertainty(const Model& model, UncertainSet parameters,
                                           std::span<const WrenchEnclosure> derivatives) {
  ReferenceUncertainty result;
  for (std::size_t k = 0; k < wrench_size; ++k) {
    Interval by_value = 0;
    Interval by_radius = 0;
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      const Enclosure& range = model.parameters[parameters[i]].range;
      const Interval magnitude = abs(Interval(derivatives[i][k].lo, derivatives[i][k].hi));
      by_value += magnitude * Interval(range.lo, range.hi);
      by_radius += magnitude * radius(range);
    }
    result.by_value[k] = {by_value.lower(), by_value.upper()};
    result.by_radius[k] = by_radius.upper();
  }
  return result;
}

ReferenceUncertainty reference_uncertainty(const Model& model, UncertainSet derivatives_over, UncertainSet parameters,
                                           Mode mode) {
  std::vector<WrenchEnclosure> derivatives;
  derivatives.reserve(parameters.size());
  for (const std::uint32_t parameter : parameters) {
    derivatives.push_back(sensitivity(model, derivatives_over, parameter, mode));
  }
  return reference_uncertainty(model, parameters, derivatives);
}

}  // namespace verisq::stance
