/// This file implements the expansion from the leaves up.
#include "verify/sets/set_terms.hpp"

#include <algorithm>

namespace verisq::verify {

namespace {

constexpr std::uint32_t bits = 32;

bool contains(const SetTerm& larger, const SetTerm& smaller) {
  return (larger.inside & ~smaller.inside) == 0 && (larger.outside & ~smaller.outside) == 0;
}

void add(std::vector<SetTerm>& terms, const SetTerm& term) {
  const auto contains_it = [&](const SetTerm& other) { return contains(other, term); };
  if (std::ranges::any_of(terms, contains_it)) return;
  std::erase_if(terms, [&](const SetTerm& other) { return contains(term, other); });
  terms.push_back(term);
}

std::vector<SetTerm> intersection(const std::vector<SetTerm>& a, const std::vector<SetTerm>& b) {
  std::vector<SetTerm> result;
  for (const SetTerm& x : a)
    for (const SetTerm& y : b) add(result, {x.inside | y.inside, x.outside | y.outside});
  return result;
}

}  // namespace

std::optional<std::vector<SetTerm>> terms_of(const SetNode& tree, std::size_t most) {
  if (tree.kind == SetNode::Kind::leaf) {
    if (tree.primitive >= bits) return std::nullopt;
    const std::uint32_t bit = 1U << tree.primitive;
    return std::vector{tree.side == Side::inside ? SetTerm{bit, 0} : SetTerm{0, bit}};
  }
  std::vector<SetTerm> result;
  for (std::size_t i = 0; i < tree.operands.size(); ++i) {
    const auto operand = terms_of(tree.operands[i], most);
    if (!operand) return std::nullopt;
    if (i == 0) {
      result = *operand;
    } else if (tree.kind == SetNode::Kind::union_of) {
      for (const SetTerm& term : *operand) add(result, term);
    } else {
      result = intersection(result, *operand);
    }
    if (result.size() > most) return std::nullopt;
  }
  return result;
}

}  // namespace verisq::verify
