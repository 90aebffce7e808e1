/// What a model asks of the methods that answer for it.
#include "verisq/model.hpp"

#include <algorithm>

namespace verisq {

namespace {

/// Marks the primitives of nested unions as used; false where the tree holds any other operation.
bool is_union(const SetExpression& expression, std::vector<bool>& used) {
  if (expression.operands.empty()) {
    used.at(expression.primitive) = true;
    return true;
  }
  return expression.operation == SetOperation::unite &&
         std::ranges::all_of(expression.operands,
                             [&](const SetExpression& operand) { return is_union(operand, used); });
}

bool unites_all(const Model& model) {
  std::vector<bool> used(model.primitives.size(), !model.csg);
  return (!model.csg || is_union(*model.csg, used)) && std::ranges::all_of(used, [](bool is_used) { return is_used; });
}

}  // namespace

bool is_bent(const Primitive& primitive) {
  return primitive.bend && primitive.bend->curvature != 0.0;
}

bool is_union_of_convex(const Model& model) {
  return unites_all(model) && std::ranges::none_of(model.primitives, is_bent);
}

}  // namespace verisq
