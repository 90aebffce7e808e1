/// This file implements the choice of terms.
#include "host/batches/model_terms.hpp"

#include <algorithm>
#include <bit>

namespace verisq::device {

using verify::SetTerm;
using verify::Side;

ModelTerms model_terms(const Model& model) {
  const auto terms = [&](Side side) {
    return verify::terms_of(verify::normal_form(model, side), most_terms).value_or(std::vector<SetTerm>{});
  };
  return {terms(Side::inside), terms(Side::outside)};
}

bool holds_balls(const ModelTerms& terms, std::size_t primitive) {
  const auto cuts_away = [&](const SetTerm& term) {
    return (term.outside >> primitive & 1U) != 0 && std::popcount(term.inside) + std::popcount(term.outside) > 1;
  };
  return primitive < 32 &&
         (std::ranges::any_of(terms.of_solid, cuts_away) || std::ranges::any_of(terms.of_complement, cuts_away));
}

}  // namespace verisq::device
