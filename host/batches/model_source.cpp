/// This file implements the translation of trees of set operations into OpenCL C.
#include "host/batches/model_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "host/batches/model_terms.hpp"
#include "kernels/embedded_sources.hpp"
#include "verify/search/has_taper.hpp"
#include "verify/sets/set_tree.hpp"

namespace verisq::device {
namespace {

using verify::SetNode;
using verify::Side;

/// Colours from the leaves up, then down again where they matter.
class ColourTranslation {
 public:
  /// A node and the name of its colour.
  struct Value {
    const SetNode* node;
    std::vector<Value> operands;
    std::string name;
  };

  Value colour_of(const SetNode& node) {
    Value value{&node, {}, {}};
    for (const SetNode& operand : node.operands) value.operands.push_back(colour_of(operand));
    value.name = fmt::format("c{}", count_++);
    text_ += fmt::format("  const colour {} = {};\n", value.name, expression(value));
    return value;
  }

  /// A node matters where its ancestors and itself are undecided; a primitive where one of its leaves does.
  void matters(const Value& value, const std::string& above) {
    if (value.node->kind == SetNode::Kind::leaf) {
      text_ += fmt::format("  matters[{}] |= {};\n", value.node->primitive, above);
      return;
    }
    const std::string within = fmt::format("m{}", value.name.substr(1));
    text_ += fmt::format("  const integer {0} = {1} & ~({2}.black | {2}.white);\n", within, above, value.name);
    for (const Value& operand : value.operands) matters(operand, within);
  }

  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  static std::string expression(const Value& value) {
    const SetNode& node = *value.node;
    if (node.kind == SetNode::Kind::leaf) {
      const std::string primitive = fmt::format("c[{}]", node.primitive);
      return node.side == Side::inside ? primitive : fmt::format("colour_complement({})", primitive);
    }
    const char* const operation = node.kind == SetNode::Kind::union_of ? "colour_union" : "colour_intersection";
    std::string result = value.operands.front().name;
    for (std::size_t i = 1; i < value.operands.size(); ++i)
      result = fmt::format("{}({}, {})", operation, result, value.operands[i].name);
    return result;
  }

  std::string text_;
  std::size_t count_ = 0;
};

/// One statement a leaf and one a pair of operands.
class NodeTranslation {
 public:
  /// Returns the name of the node's value.
  std::string node_of(const SetNode& node) {
    if (node.kind == SetNode::Kind::leaf)
      return declare(fmt::format("visit_leaf(v, {}U, {})", node.primitive, node.side == Side::outside));
    std::string result = node_of(node.operands.front());
    for (std::size_t i = 1; i < node.operands.size(); ++i) {
      const std::string operand = node_of(node.operands[i]);
      result = declare(
          fmt::format("visit_operands(v, {}, {}, {})", node.kind == SetNode::Kind::intersection_of, result, operand));
    }
    return result;
  }

  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string declare(const std::string& value) {
    const std::string name = fmt::format("n{}", count_++);
    text_ += fmt::format("  const node {} = {};\n", name, value);
    return name;
  }

  std::string text_;
  std::size_t count_ = 0;
};

std::string solid_colour(const SetNode& tree) {
  ColourTranslation translation;
  const auto root = translation.colour_of(tree);
  translation.matters(root, "INTEGER(-1)");
  return fmt::format("\nstatic colour solid_colour(const colour* c, integer* matters) {{\n{}  return {};\n}}\n",
                     translation.text(), root.name);
}

std::string solid_node(const SetNode& tree) {
  NodeTranslation translation;
  const std::string root = translation.node_of(tree);
  return fmt::format("\nNEVER_INLINE node solid_node(const visit* v) {{\n{}  return {};\n}}\n", translation.text(),
                     root);
}

std::string bits_of(const ModelTerms& terms, std::uint32_t verify::SetTerm::*literals) {
  std::string text;
  for (const auto* const target : {&terms.of_solid, &terms.of_complement})
    for (const verify::SetTerm& term : *target) text += fmt::format("{:#x}U, ", term.*literals);
  return text + "0U";  // no array is empty
}

/// Those of the closure of the complement after those of the solid.
std::string terms_of_both(const Model& model) {
  const ModelTerms terms = model_terms(model);
  return fmt::format(
      "#define TERMS_OF_SOLID {}U\n#define TERMS_OF_COMPLEMENT {}U\n"
      "constant uint term_inside[] = {{{}}};\nconstant uint term_outside[] = {{{}}};\n",
      terms.of_solid.size(), terms.of_complement.size(), bits_of(terms, &verify::SetTerm::inside),
      bits_of(terms, &verify::SetTerm::outside));
}

}  // namespace

std::string why_not_compiled(const Model& model) {
  // Kernels hold the colours of all primitives, whether the tree has them or not.
  const std::size_t leaves = verify::size_of_tree(model);
  if (leaves <= most_compiled_leaves) return {};
  return fmt::format("the model's tree has {} leaves, of which the device's kernels take {}: the host does all", leaves,
                     most_compiled_leaves);
}

std::string model_source(const Model& model, std::string_view entry_points) {
  const SetNode tree = verify::normal_form(model, Side::inside);
  const std::string_view layers =
      verify::has_taper(model) ? kernels::embedded_tapered_solid_layers() : kernels::embedded_solid_layers();
  return fmt::format("#define PRIMITIVES {}U\n{}{}{}{}{}", model.primitives.size(), terms_of_both(model), layers,
                     entry_points, solid_colour(tree), solid_node(tree));
}

std::string solid_source(const Model& model) {
  const bool both = std::ranges::any_of(model.primitives, [](const Primitive& primitive) {
    return is_bent(primitive) && is_tapered(primitive.superquadric);
  });
  std::string entry_points(both ? kernels::embedded_tapered_bent_distance() : kernels::embedded_bent_distance());
  entry_points += kernels::embedded_set_bounds();
  entry_points += kernels::embedded_solid_distance();
  return model_source(model, entry_points);
}

}  // namespace verisq::device
