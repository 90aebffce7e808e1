/// Where a point lies relative to a tree of closed sets: the three-valued logic of inside, boundary and outside.
#pragma once

#include <algorithm>
#include <cstdint>
#include <verisq/model.hpp>

namespace verisq::oracle {

/// In the exterior, in the interior, or not known. Ordered, so that a union takes the largest of its operands, an
/// intersection the smallest.
enum class Membership { outside, boundary, inside };

[[nodiscard]] constexpr Membership complement(Membership m) {
  if (m == Membership::boundary) return m;
  return m == Membership::inside ? Membership::outside : Membership::inside;
}

/// `leaf(i)` is the membership in primitive i. A difference A \ B_1 \ ... is A and not B_1 and not ...; what is decided
/// here is decided for the closed sets of the header as well, because it is decided for interiors and exteriors.
template <class Leaf>
[[nodiscard]] Membership membership(const SetExpression& expression, const Leaf& leaf) {
  if (expression.operands.empty()) return leaf(expression.primitive);
  Membership result = membership(expression.operands.front(), leaf);
  for (std::size_t i = 1; i < expression.operands.size(); ++i) {
    const auto operand = [&] { return membership(expression.operands[i], leaf); };
    switch (expression.operation) {
      case SetOperation::unite:
        if (result == Membership::inside) return result;
        result = std::max(result, operand());
        break;
      case SetOperation::intersect:
        if (result == Membership::outside) return result;
        result = std::min(result, operand());
        break;
      case SetOperation::subtract:
        if (result == Membership::outside) return result;
        result = std::min(result, complement(operand()));
        break;
    }
  }
  return result;
}

template <class Leaf>
[[nodiscard]] Membership membership(const Model& model, const Leaf& leaf) {
  if (model.csg) return membership(*model.csg, leaf);
  Membership result = leaf(0);
  for (std::uint32_t i = 1; i < model.primitives.size() && result != Membership::inside; ++i) {
    result = std::max(result, leaf(i));
  }
  return result;
}

}  // namespace verisq::oracle
