/// What a model asks of the methods that answer for it.
#include "verisq/model.hpp"

#include <algorithm>

#include "verify/proof/convex_union.hpp"

namespace verisq {

namespace {

/// Marks the primitives of nested unions as used; false where the tree holds any other operation.
bool unites(const SetExpression& expression, std::vector<bool>& used) {
  if (expression.operands.empty()) {
    used.at(expression.primitive) = true;
    return true;
  }
  return expression.operation == SetOperation::unite &&
         std::ranges::all_of(expression.operands, [&](const SetExpression& operand) { return unites(operand, used); });
}

}  // namespace

bool verify::is_union(const Model& model) {
  std::vector<bool> used(model.primitives.size(), !model.csg);
  return (!model.csg || unites(*model.csg, used)) && std::ranges::all_of(used, [](bool is_used) { return is_used; });
}

bool is_bent(const Primitive& primitive) {
  return primitive.bend && primitive.bend->curvature != 0.0;
}

std::string name_of_primitive(const Model& model, std::size_t primitive) {
  const std::string& name = model.primitives[primitive].name;
  return name.empty() ? "primitives[" + std::to_string(primitive) + "]" : name;
}

bool is_union_of_convex(const Model& model) {
  return verify::is_union(model) && std::ranges::none_of(model.primitives, is_bent);
}

}  // namespace verisq
