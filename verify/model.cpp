/// What a model asks of the methods that answer for it.
#include "verisq/model.hpp"

#include <algorithm>
#include <string>

#include "verify/convex_union.hpp"
#include "verisq/error.hpp"

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

bool is_convex(const Primitive& primitive) {
  return !primitive.bend || primitive.bend->curvature == 0.0;
}

[[noreturn]] void refuse(std::string_view what, const std::string& solids) {
  throw Error(ErrorKind::input, std::string(what) + ": not supported for " + solids);
}

}  // namespace

bool is_union_of_convex(const Model& model) {
  return unites_all(model) && std::ranges::all_of(model.primitives, is_convex);
}

namespace verify {

void require_union_of_convex(const Model& model, std::string_view what) {
  const auto bent = std::ranges::find_if_not(model.primitives, is_convex);
  if (bent != model.primitives.end()) {
    refuse(what, "bent solids: primitives[" + std::to_string(bent - model.primitives.begin()) + "].bend");
  }
  if (!unites_all(model)) refuse(what, "csg other than the union of all primitives");
}

void require_convex(const Primitive& primitive, std::string_view what) {
  if (!is_convex(primitive)) refuse(what, "bent solids");
}

}  // namespace verify

}  // namespace verisq
