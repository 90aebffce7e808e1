/// The terms of a model's solid and of the closure of its complement, as kernels/set_bounds.cl takes them.
#pragma once

#include <cstddef>
#include <vector>

#include "verify/sets/set_terms.hpp"
#include "verisq/model.hpp"

namespace verisq::device {

/// None of a target that has more than `most_terms`: it is left to the search.
struct ModelTerms {
  std::vector<verify::SetTerm> of_solid;
  std::vector<verify::SetTerm> of_complement;
};

inline constexpr std::size_t most_terms = 32;

[[nodiscard]] ModelTerms model_terms(const Model& model);

/// Whether set_bounds may ask for balls in the primitive: where it is cut away from others.
[[nodiscard]] bool holds_balls(const ModelTerms& terms, std::size_t primitive);

}  // namespace verisq::device
