/// De Morgan once, then three-valued logic.
#include "verify/sets/set_tree.hpp"

#include <algorithm>
#include <iterator>
#include <optional>
#include <set>
#include <utility>

namespace verisq::verify {

namespace {

using Kind = SetNode::Kind;

Side opposite(Side side) {
  return side == Side::inside ? Side::outside : Side::inside;
}

Colour opposite(Colour colour) {
  if (colour == Colour::gray) return colour;
  return colour == Colour::white ? Colour::black : Colour::white;
}

SetNode leaf(std::uint32_t primitive, Side side) {
  return {Kind::leaf, primitive, side, {}};
}

/// A complement turns unions into intersections and back.
Kind kind_of(const SetExpression& expression, Side side) {
  return (expression.operation == SetOperation::unite) == (side == Side::inside) ? Kind::union_of
                                                                                 : Kind::intersection_of;
}

/// Appends the expression's operands to those of a node of this kind: an operand of the same kind gives its own, one
/// operand alone takes the place of its operator. Every node is made where it stays, so that deep trees cost no more
/// than wide ones.
void append_operands(const SetExpression& expression, Side side, Kind kind, std::vector<SetNode>& operands) {
  if (expression.operands.empty()) {
    operands.push_back(leaf(expression.primitive, side));
    return;
  }
  const Kind own = kind_of(expression, side);
  const bool dissolves = own == kind || expression.operands.size() == 1;
  std::vector<SetNode>& into = dissolves ? operands : operands.emplace_back(SetNode{own}).operands;
  const bool subtract = expression.operation == SetOperation::subtract;
  for (std::size_t i = 0; i < expression.operands.size(); ++i) {
    const bool removed = subtract && i > 0;
    append_operands(expression.operands[i], removed ? opposite(side) : side, dissolves ? kind : own, into);
  }
}

SetNode normal_form(const SetExpression& expression, Side side) {
  const Kind kind = kind_of(expression, side);
  std::vector<SetNode> operands;
  append_operands(expression, side, kind, operands);
  if (operands.size() == 1) return std::move(operands.front());
  return {kind, 0, Side::inside, std::move(operands)};
}

/// The colour of one operand that decides the whole; an operand of the other colour does not matter.
Colour deciding(Kind kind) {
  return kind == Kind::union_of ? Colour::black : Colour::white;
}

Colour colour_of_leaf(const SetNode& leaf, std::span<const Colour> primitives) {
  const Colour inside = primitives[leaf.primitive];
  return leaf.side == Side::inside ? inside : opposite(inside);
}

/// Puts the shorter list behind the longer one: however deep the tree, no node is moved more often than the logarithm
/// of their number. The order of operands means nothing.
void append(std::vector<SetNode>& operands, std::vector<SetNode> more) {
  if (operands.size() < more.size()) std::swap(operands, more);
  std::ranges::move(more, std::back_inserter(operands));
}

/// Returns the node's colour; where it is gray, appends what is left of the node to the operands of one of this kind.
Colour append_undecided(const SetNode& node, std::span<const Colour> primitives, Kind kind,
                        std::vector<SetNode>& operands) {
  if (node.kind == Kind::leaf) {
    const Colour found = colour_of_leaf(node, primitives);
    if (found == Colour::gray) operands.push_back(node);
    return found;
  }
  std::vector<SetNode> undecided;
  for (const SetNode& operand : node.operands) {
    if (append_undecided(operand, primitives, node.kind, undecided) == deciding(node.kind)) return deciding(node.kind);
  }
  if (undecided.empty()) return opposite(deciding(node.kind));
  if (undecided.size() == 1 && undecided.front().kind == kind) {
    append(operands, std::exchange(undecided.front().operands, {}));
  } else if (undecided.size() == 1 || node.kind == kind) {
    append(operands, std::move(undecided));
  } else {
    operands.push_back({node.kind, 0, Side::inside, std::move(undecided)});
  }
  return Colour::gray;
}

std::size_t leaves_of(const SetExpression& expression) {
  if (expression.operands.empty()) return 1;
  std::size_t count = 0;
  for (const SetExpression& operand : expression.operands) count += leaves_of(operand);
  return count;
}

/// Nothing where no primitives hold the set: it need not be bounded then.
std::optional<std::set<std::uint32_t>> covering(const SetNode& node) {
  if (node.kind == Kind::leaf) {
    if (node.side == Side::outside) return std::nullopt;
    return std::set{node.primitive};
  }
  std::set<std::uint32_t> all;
  for (const SetNode& operand : node.operands) {
    const std::optional<std::set<std::uint32_t>> found = covering(operand);
    if (node.kind == Kind::intersection_of && found) return found;
    if (node.kind == Kind::union_of && !found) return std::nullopt;
    if (found) all.insert(found->begin(), found->end());
  }
  if (node.kind == Kind::intersection_of) return std::nullopt;
  return all;
}

}  // namespace

/// The solid is bounded: trees have no complement but in differences, whose first operand comes first.
std::vector<std::uint32_t> covering_primitives(const Model& model) {
  const std::set<std::uint32_t> found = covering(normal_form(model, Side::inside)).value();
  return {found.begin(), found.end()};
}

std::size_t size_of_tree(const Model& model) {
  return std::max(model.csg ? leaves_of(*model.csg) : 0, model.primitives.size());
}

SetNode normal_form(const Model& model, Side side) {
  if (model.csg) return normal_form(*model.csg, side);
  SetExpression all;
  for (std::uint32_t i = 0; i < model.primitives.size(); ++i) {
    all.operands.push_back({.operands = {}, .operation = SetOperation::unite, .primitive = i});
  }
  return normal_form(all, side);
}

Colour colour(const SetNode& node, std::span<const Colour> primitives) {
  if (node.kind == Kind::leaf) return colour_of_leaf(node, primitives);
  const Colour decides = deciding(node.kind);
  bool undecided = false;
  for (const SetNode& operand : node.operands) {
    const Colour found = colour(operand, primitives);
    if (found == decides) return decides;
    undecided = undecided || found == Colour::gray;
  }
  return undecided ? Colour::gray : opposite(decides);
}

SetNode simplified(const SetNode& node, std::span<const Colour> primitives) {
  if (node.kind == Kind::leaf) return node;
  std::vector<SetNode> operands;
  append_undecided(node, primitives, node.kind, operands);
  if (operands.size() == 1) return std::move(operands.front());
  return {node.kind, 0, Side::inside, std::move(operands)};
}

}  // namespace verisq::verify
