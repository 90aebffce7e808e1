/// This file implements solid_model.hpp.
#include "host/device/solid_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "host/device/device_model.hpp"
#include "host/device/primitive_parameters.hpp"
#include "kernels/embedded_sources.hpp"
#include "verify/search/certified_distance.hpp"
#include "verify/search/octree_cube.hpp"
#include "verify/search/set_tree.hpp"

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

/// The terms of the closure of the complement follow those of the solid.
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
  // Kernels store the colours of all primitives, whether the tree has them or not.
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

using verify::SetTerm;
using verify::Side;

ModelTerms model_terms(const Model& model) {
  const auto terms = [&](Side side) {
    return verify::terms_of(verify::normal_form(model, side), most_terms).value_or(std::vector<SetTerm>{});
  };
  return {terms(Side::inside), terms(Side::outside)};
}

bool holds_balls(const ModelTerms& terms, std::size_t primitive) {
  const auto cuts_away = [&](const SetTerm& term) {
    return (term.outside >> primitive & 1U) != 0 && std::popcount(term.inside) + std::popcount(term.outside) > 1;
  };
  return primitive < 32 &&
         (std::ranges::any_of(terms.of_solid, cuts_away) || std::ranges::any_of(terms.of_complement, cuts_away));
}

namespace {

// Room about the solid for points that are proven to lie outside; it makes up for the scaling's rounding, too.
constexpr double margin = 1.0 / 64.0;
constexpr double farthest = 16.0;

}  // namespace

verify::Cube root_cube(const Model& model, int scale_exponent) {
  verify::Box box = verify::bounding_box(model);
  for (std::size_t i = 0; i < 3; ++i) {
    box.lower[i] = std::ldexp(box.lower[i], scale_exponent);
    box.upper[i] = std::ldexp(box.upper[i], scale_exponent);
  }
  return verify::root_cube(box, {.margin = margin, .farthest = farthest}).value();
}

cl::Buffer uploaded_box_primitives(const Device& device, const Model& model, int scale_exponent) {
  std::vector<BoxPrimitiveParameters> parameters;
  for (const Primitive& primitive : model.primitives)
    parameters.push_back(box_primitive_parameters(primitive, scale_exponent));
  return {device.context, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, parameters.size() * sizeof(BoxPrimitiveParameters),
          parameters.data()};
}

std::string box_primitives_memory(const Device& device, const Model& model) {
  return model_memory_option(device, model.primitives.size() * sizeof(BoxPrimitiveParameters));
}

namespace {

constexpr double no_edge = -1.0;          // as in kernels/set_bounds.cl
constexpr double nearly_the_same = 1e-9;  // of a distance, in units of the model's size

// Rotates by the transpose.
Point turned_back(const std::array<double, 9>& r, const Point& v) {
  return {r[0] * v[0] + r[3] * v[1] + r[6] * v[2], r[1] * v[0] + r[4] * v[1] + r[7] * v[2],
          r[2] * v[0] + r[5] * v[1] + r[8] * v[2]};
}

Point times(double s, const Point& v) {
  return {s * v[0], s * v[1], s * v[2]};
}

}  // namespace

SolidDirections::SolidDirections(const Model& model, int scale_exponent, std::size_t capacity) : capacity_(capacity) {
  for (const Primitive& primitive : model.primitives) {
    const BoxPrimitiveParameters parameters = box_primitive_parameters(primitive, scale_exponent);
    Rotation frame{};
    std::ranges::copy(parameters.frame, frame.begin());
    frames_.push_back(frame);
  }
  evidence_.resize(frames_.size() * columns_of_primitive * capacity_);
  for (std::vector<double>& column : edges_) column.resize(capacity_);
}

std::span<double> SolidDirections::column(std::size_t primitive, std::size_t index) {
  return std::span(evidence_).subspan((primitive * columns_of_primitive + index) * capacity_, capacity_);
}

double SolidDirections::number(std::size_t primitive, std::size_t index, std::size_t n) const {
  return evidence_[(primitive * columns_of_primitive + index) * capacity_ + n];
}

void SolidDirections::read(ChunkQueue& queue, std::span<const EvidenceBuffers> primitives, const Edges& edges,
                           std::size_t size) {
  for (std::size_t i = 0; i < primitives.size(); ++i)
    for (std::size_t k = 0; k < columns_of_primitive; ++k) queue.read(primitives[i][k], column(i, k).first(size));
  queue.read(edges.names, std::span(edges_[0]).first(size));
  for (std::size_t k = 0; k < 3; ++k) queue.read(edges.feet[k], std::span(edges_[k + 1]).first(size));
}

// Normals lead out of primitives; a signed distance is that of a primitive or, where one is cut away, minus that.
Point SolidDirections::operator()(std::size_t n, const Point& at, const Enclosure& distance) const {
  const double middle = 0.5 * distance.lo + 0.5 * distance.hi;
  double least = distance.width() + nearly_the_same;
  Point direction{};
  const auto offer = [&](double signed_distance, double sign, const Point& outward) {
    const double off = std::abs(sign * signed_distance - middle);
    if (!(off < least)) return;
    least = off;
    direction = times(sign, outward);
  };
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    // The end that the nearest point found proves.
    const double own = number(i, 1, n) > 0.0 ? number(i, 1, n) : number(i, 0, n);
    const Point outward = turned_back(frames_[i], {number(i, 2, n), number(i, 3, n), number(i, 4, n)});
    offer(own, 1.0, outward);
    offer(own, -1.0, outward);
  }
  if (edges_[0][n] == no_edge) return direction;
  const Point way{at[0] - edges_[1][n], at[1] - edges_[2][n], at[2] - edges_[3][n]};
  const double length = std::hypot(way[0], way[1], way[2]);
  offer(length, middle < 0.0 ? -1.0 : 1.0, way);
  return direction;
}

}  // namespace verisq::device
