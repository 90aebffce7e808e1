/// This file implements the translation: colours from the leaves up, then down again where they matter.
#include "host/device/octree_source.hpp"

#include <fmt/format.h>

#include "verify/set_tree.hpp"

namespace verisq::device {
namespace {

using verify::SetNode;
using verify::Side;

class Translation {
 public:
  /// `node` in the numbers of this translation: in the order in which its colour is computed.
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

}  // namespace

OctreeSource octree_source(const Model& model) {
  const SetNode tree = verify::normal_form(model, Side::inside);
  Translation translation;
  const auto root = translation.colour_of(tree);
  translation.matters(root, "INTEGER(-1)");
  return {fmt::format("\n#define PRIMITIVES {}U\n", model.primitives.size()),
          fmt::format("\nstatic colour solid_colour(const colour* c, integer* matters) {{\n{}  return {};\n}}\n",
                      translation.text(), root.name)};
}

}  // namespace verisq::device
