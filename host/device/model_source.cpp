/// This file implements the translation of trees of set operations into OpenCL C.
#include "host/device/model_source.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <vector>

namespace verisq::device {
namespace {

/// A value of the function that is being written: its name and the primitives that occur below it and nowhere else, as
/// bits. Only they cease to matter where its colour is decided.
struct Value {
  std::string name;
  std::uint32_t own_leaves;
};

bool is_bent(const Primitive& primitive) {
  return primitive.bend && primitive.bend->curvature != 0.0;
}

std::uint32_t bit_of(std::uint32_t primitive) {
  return std::uint32_t{1} << primitive;
}

/// Nothing in `csg` means the union of all primitives.
SetExpression expression_of(const Model& model) {
  if (model.csg) return *model.csg;
  SetExpression all;
  for (std::uint32_t i = 0; i < model.primitives.size(); ++i) all.operands.push_back({{}, SetOperation::unite, i});
  return all;
}

void count_leaves(const SetExpression& expression, std::vector<std::size_t>& counts) {
  if (expression.operands.empty()) ++counts[expression.primitive];
  for (const SetExpression& operand : expression.operands) count_leaves(operand, counts);
}

/// Writes one statement a node of the tree, leaves first; `Notation` says how nodes are written.
template <class Notation>
class Translation {
 public:
  Translation(const Model& model, const SetExpression& whole) : model_(model), occurrences_(model.primitives.size()) {
    count_leaves(whole, occurrences_);
  }

  /// Of the set, or of the closure of its complement where `negated`: De Morgan moves negations to the leaves.
  Value translate(const SetExpression& expression, bool negated) {
    if (expression.operands.empty()) return leaf(expression.primitive, negated);
    const bool subtracts = expression.operation == SetOperation::subtract;
    const bool intersects = (expression.operation != SetOperation::unite) != negated;
    Value result = translate(expression.operands.front(), negated);
    for (std::size_t i = 1; i < expression.operands.size(); ++i)
      result = combined(result, translate(expression.operands[i], negated != subtracts), intersects);
    return result;
  }

  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  Value leaf(std::uint32_t primitive, bool negated) {
    const Value value = next(occurrences_[primitive] == 1 ? bit_of(primitive) : 0);
    const std::string_view map = is_bent(model_.primitives[primitive]) ? "bent" : "posed";
    text_ += Notation::leaf(value.name, primitive, bit_of(primitive), map, negated);
    return value;
  }

  Value combined(const Value& a, const Value& b, bool intersects) {
    const Value value = next(a.own_leaves | b.own_leaves);
    text_ += Notation::combined(value.name, a.name, b.name, intersects);
    text_ += fmt::format("  *more = note_node(*more, {}, {:#x}u);\n", Notation::colour(value.name), value.own_leaves);
    return value;
  }

  Value next(std::uint32_t own_leaves) { return {fmt::format("v{}", count_++), own_leaves}; }

  const Model& model_;
  std::vector<std::size_t> occurrences_;  // of each primitive in the whole tree
  std::string text_;
  std::size_t count_ = 0;
};

struct ColourNotation {
  static std::string leaf(std::string_view name, std::uint32_t primitive, std::uint32_t bit, std::string_view map,
                          bool negated) {
    return fmt::format(
        "  colour {0} = known_colour(known, {1:#x}u);\n"
        "  if (!((known.black | known.white) & {1:#x}u)) {{\n"
        "    {0} = {2}_colour(x, primitives + {3});\n"
        "    *more = note_leaf(*more, {0}, {1:#x}u);\n"
        "  }}\n"
        "  {0} = colour_on_side({0}, {4});\n",
        name, bit, map, primitive, negated);
  }
  static std::string combined(std::string_view name, std::string_view a, std::string_view b, bool intersects) {
    return fmt::format("  const colour {} = {}({}, {});\n", name, intersects ? "colour_intersection" : "colour_union",
                       a, b);
  }
  static std::string colour(std::string_view name) { return std::string(name); }
};

struct NodeNotation {
  static std::string leaf(std::string_view name, std::uint32_t primitive, std::uint32_t bit, std::string_view map,
                          bool negated) {
    return fmt::format(
        "  const bool outside_{0} = outside != {4};\n"
        "  node {0} = decided_node(query.q, colour_on_side(known_colour(known, {1:#x}u), outside_{0}), query.reach);\n"
        "  if (!((known.black | known.white) & {1:#x}u)) {{\n"
        "    {0} = {2}_node(x, query, outside_{0}, outside_{0} ? least_outside[{3}] : least_inside[{3}],\n"
        "                    primitives + {3});\n"
        "    *more = note_leaf_node(*more, {0}, outside_{0}, {1:#x}u);\n"
        "  }}\n",
        name, bit, map, primitive, negated);
  }
  static std::string combined(std::string_view name, std::string_view a, std::string_view b, bool intersects) {
    return fmt::format("  const node {} = node_combined(outside != {}, {}, {}, query.q, query.reach);\n", name,
                       intersects, a, b);
  }
  static std::string colour(std::string_view name) { return fmt::format("{}.colour", name); }
};

template <class Notation>
std::string function(const Model& model, std::string_view signature) {
  const SetExpression whole = expression_of(model);
  Translation<Notation> body(model, whole);
  const Value result = body.translate(whole, false);
  return fmt::format("\nNEVER_INLINE {} {{\n{}  return {};\n}}\n", signature, body.text(), result.name);
}

}  // namespace

std::string model_source(const Model& model) {
  return fmt::format(
             "\n// This text implements the tree of one model; the host generated it.\n\n#define PRIMITIVES {}\n",
             model.primitives.size()) +
         function<ColourNotation>(model,
                                  "colour model_colour(cube x, decided known, constant const box_primitive* "
                                  "primitives, newly_decided* more)") +
         function<NodeNotation>(model,
                                "node model_node(cube x, cut_query query, bool outside, decided known, const double* "
                                "least_inside,\n                              const double* least_outside, constant "
                                "const box_primitive* primitives,\n                              newly_decided* more)");
}

}  // namespace verisq::device
