/// De Morgan once, then three-valued logic.
#include "verify/set_tree.hpp"

#include <algorithm>
#include <iterator>
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

/// An operand of the same kind gives its own operands; one operand alone is the result. Precondition: one at least.
SetNode joined(Kind kind, std::vector<SetNode> operands) {
  if (operands.size() == 1) return std::move(operands.front());
  SetNode result{kind, 0, Side::inside, {}};
  for (SetNode& operand : operands) {
    if (operand.kind == kind) {
      std::ranges::move(operand.operands, std::back_inserter(result.operands));
    } else {
      result.operands.push_back(std::move(operand));
    }
  }
  return result;
}

SetNode normal_form(const SetExpression& expression, Side side) {
  if (expression.operands.empty()) return leaf(expression.primitive, side);
  const bool subtract = expression.operation == SetOperation::subtract;
  std::vector<SetNode> operands;
  for (const SetExpression& operand : expression.operands) {
    const bool removed = subtract && !operands.empty();
    operands.push_back(normal_form(operand, removed ? opposite(side) : side));
  }
  // A complement turns unions into intersections and back.
  const bool unites = (expression.operation == SetOperation::unite) == (side == Side::inside);
  return joined(unites ? Kind::union_of : Kind::intersection_of, std::move(operands));
}

/// The colour of one operand that decides the whole; an operand of the other colour does not matter.
Colour deciding(Kind kind) {
  return kind == Kind::union_of ? Colour::black : Colour::white;
}

}  // namespace

SetNode normal_form(const Model& model, Side side) {
  if (model.csg) return normal_form(*model.csg, side);
  SetExpression all;
  for (std::uint32_t i = 0; i < model.primitives.size(); ++i) {
    all.operands.push_back({.operands = {}, .operation = SetOperation::unite, .primitive = i});
  }
  return normal_form(all, side);
}

void mark_primitives(const SetNode& node, std::vector<bool>& marks) {
  if (node.kind == Kind::leaf) marks.at(node.primitive) = true;
  for (const SetNode& operand : node.operands) mark_primitives(operand, marks);
}

Colour colour(const SetNode& node, std::span<const Colour> primitives) {
  if (node.kind == Kind::leaf) {
    const Colour inside = primitives[node.primitive];
    return node.side == Side::inside ? inside : opposite(inside);
  }
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
  for (const SetNode& operand : node.operands) {
    // No operand has the deciding colour: the node is gray.
    if (colour(operand, primitives) == Colour::gray) operands.push_back(simplified(operand, primitives));
  }
  return joined(node.kind, std::move(operands));
}

}  // namespace verisq::verify
