/// Trees of set operations with as many leaves as one asks for, and models of so many balls.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>
#include <verisq/model.hpp>

namespace verisq::testing {

/// The operation of a node whose children's leaves begin at this primitive.
using OperationOf = SetOperation (*)(std::uint32_t primitive);

inline SetOperation always_union(std::uint32_t /*primitive*/) {
  return SetOperation::unite;
}

/// All three, in turn.
inline SetOperation in_turn(std::uint32_t primitive) {
  constexpr std::array all{SetOperation::unite, SetOperation::intersect, SetOperation::unite, SetOperation::subtract};
  return all[primitive % all.size()];
}

inline SetExpression leaf(std::uint32_t primitive) {
  return {.primitive = primitive};
}

/// ((0 op 1) op 2) op 3 ...: `leaves` - 1 deep, nested in first operands.
inline SetExpression deep_tree(std::uint32_t leaves, OperationOf operation) {
  SetExpression tree = leaf(0);
  for (std::uint32_t i = 1; i < leaves; ++i) {
    SetExpression next{.operation = operation(i)};
    next.operands.push_back(std::move(tree));
    next.operands.push_back(leaf(i));
    tree = std::move(next);
  }
  return tree;
}

/// ... (n-3 op (n-2 op (n-1))): nested in last operands.
inline SetExpression deep_tree_of_last_operands(std::uint32_t leaves, OperationOf operation) {
  SetExpression tree = leaf(leaves - 1);
  for (std::uint32_t i = leaves - 1; i-- > 0;) {
    SetExpression next{.operation = operation(i)};
    next.operands.push_back(leaf(i));
    next.operands.push_back(std::move(tree));
    tree = std::move(next);
  }
  return tree;
}

/// One operation on all.
inline SetExpression wide_tree(std::uint32_t leaves, SetOperation operation) {
  SetExpression tree{.operation = operation};
  for (std::uint32_t i = 0; i < leaves; ++i) tree.operands.push_back(leaf(i));
  return tree;
}

/// Of the leaves first, first + 1, ..., last - 1.
inline SetExpression balanced_tree(std::uint32_t first, std::uint32_t last, OperationOf operation) {
  if (last - first == 1) return leaf(first);
  const std::uint32_t middle = first + (last - first) / 2;
  SetExpression tree{.operation = operation(middle)};
  tree.operands.push_back(balanced_tree(first, middle, operation));
  tree.operands.push_back(balanced_tree(middle, last, operation));
  return tree;
}

/// Balls on a cubic grid with the spacing 1; those with a radius above 1/2 overlap.
inline std::vector<Primitive> grid_of_balls(std::uint32_t count, double radius) {
  const auto side = static_cast<std::uint32_t>(std::ceil(std::cbrt(count)));
  std::vector<Primitive> balls;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Point centre{static_cast<double>(i % side), static_cast<double>(i / side % side),
                       static_cast<double>(i / side / side)};
    balls.push_back({"", {{radius, radius, radius}, {1.0, 1.0}}, {centre, {1.0, 0.0, 0.0, 0.0}}});
  }
  return balls;
}

}  // namespace verisq::testing
