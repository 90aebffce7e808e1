/// This file implements set_tree.hpp.
#include "verify/search/set_tree.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "verify/proof/posed_superquadric.hpp"
#include "verify/proposals/gjk.hpp"
#include "verify/search/closed_mesh.hpp"
#include "verify/search/convex_primitive.hpp"
#include "verify/solids/bend.hpp"
#include "verify/solids/model.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"

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

/// Appends the expression's operands to those of a node of this kind. An operand of the same kind gives its own
/// operands; an only operand takes the place of its operator. Every node is made where it stays, so that deep trees
/// cost no more than wide ones.
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

/// The colour that decides the whole if one operand has it; operands of the other colour do not matter.
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

/// Returns the node's colour. If it is gray, appends the simplified node to the operands of a node of this kind.
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

/// The colour of the set by the colour of each leaf.
template <class ColourOfLeaf>
Colour colour_by(const SetNode& node, const ColourOfLeaf& colour_of) {
  if (node.kind == Kind::leaf) return colour_of(node);
  const Colour decides = deciding(node.kind);
  bool undecided = false;
  for (const SetNode& operand : node.operands) {
    const Colour found = colour_by(operand, colour_of);
    if (found == decides) return decides;
    undecided = undecided || found == Colour::gray;
  }
  return undecided ? Colour::gray : opposite(decides);
}

void append_primitives(const SetNode& node, Side side, std::set<std::uint32_t>& primitives) {
  if (node.kind == Kind::leaf && node.side == side) primitives.insert(node.primitive);
  for (const SetNode& operand : node.operands) append_primitives(operand, side, primitives);
}

std::size_t leaves_of(const SetExpression& expression) {
  if (expression.operands.empty()) return 1;
  std::size_t count = 0;
  for (const SetExpression& operand : expression.operands) count += leaves_of(operand);
  return count;
}

/// Nothing if no primitives contain the set: then it may be unbounded.
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
  return colour_by(node, [&](const SetNode& leaf) { return colour_of_leaf(leaf, primitives); });
}

Colour colour_of_surface(const SetNode& node, std::span<const Colour> primitives, std::uint32_t surface) {
  return colour_by(node, [&](const SetNode& leaf) {
    return leaf.primitive == surface ? Colour::black : colour_of_leaf(leaf, primitives);
  });
}

std::vector<std::uint32_t> on_both_sides(const SetNode& node) {
  std::array<std::set<std::uint32_t>, 2> primitives;
  append_primitives(node, Side::inside, primitives[0]);
  append_primitives(node, Side::outside, primitives[1]);
  std::vector<std::uint32_t> both;
  std::ranges::set_intersection(primitives[0], primitives[1], std::back_inserter(both));
  return both;
}

SetNode simplified(const SetNode& node, std::span<const Colour> primitives) {
  if (node.kind == Kind::leaf) return node;
  std::vector<SetNode> operands;
  append_undecided(node, primitives, node.kind, operands);
  if (operands.size() == 1) return std::move(operands.front());
  return {node.kind, 0, Side::inside, std::move(operands)};
}

namespace {

constexpr std::uint32_t bits = 32;

bool contains(const SetTerm& larger, const SetTerm& smaller) {
  return (larger.inside & ~smaller.inside) == 0 && (larger.outside & ~smaller.outside) == 0;
}

void add(std::vector<SetTerm>& terms, const SetTerm& term) {
  const auto contains_it = [&](const SetTerm& other) { return contains(other, term); };
  if (std::ranges::any_of(terms, contains_it)) return;
  std::erase_if(terms, [&](const SetTerm& other) { return contains(term, other); });
  terms.push_back(term);
}

std::vector<SetTerm> terms_of_both(const std::vector<SetTerm>& a, const std::vector<SetTerm>& b) {
  std::vector<SetTerm> result;
  for (const SetTerm& x : a)
    for (const SetTerm& y : b) add(result, {x.inside | y.inside, x.outside | y.outside});
  return result;
}

}  // namespace

std::optional<std::vector<SetTerm>> terms_of(const SetNode& tree, std::size_t most) {
  if (tree.kind == SetNode::Kind::leaf) {
    if (tree.primitive >= bits) return std::nullopt;
    const std::uint32_t bit = 1U << tree.primitive;
    return std::vector{tree.side == Side::inside ? SetTerm{bit, 0} : SetTerm{0, bit}};
  }
  std::vector<SetTerm> result;
  for (std::size_t i = 0; i < tree.operands.size(); ++i) {
    const auto operand = terms_of(tree.operands[i], most);
    if (!operand) return std::nullopt;
    if (i == 0) {
      result = *operand;
    } else if (tree.kind == SetNode::Kind::union_of) {
      for (const SetTerm& term : *operand) add(result, term);
    } else {
      result = terms_of_both(result, *operand);
    }
    if (result.size() > most) return std::nullopt;
  }
  return result;
}

namespace {

Box outward_box(const PreciseVector& x) {
  Box box{};
  for (std::size_t i = 0; i < 3; ++i) {
    const PreciseInterval& range = x[i];
    box.lower[i] = range.lower().to_double(Direction::down);
    box.upper[i] = range.upper().to_double(Direction::up);
  }
  return box;
}

/// The box of all vertices, each in its place.
Box box_of(const Mesh& mesh, const Pose& pose) {
  const RigidMotion motion(pose);
  Box box{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  const bool moves = !is_at_rest(pose);
  for (const Point& vertex : mesh.vertices)
    box = hull(box, moves ? outward_box(motion(precise(vertex))) : Box{vertex, vertex});
  return box;
}

Box box_of(const Primitive& primitive) {
  if (primitive.mesh) return box_of(*primitive.mesh, primitive.pose);
  if (!is_bent(primitive)) return outward_box(ConvexPrimitive(primitive).bounding_box());
  const RigidMotion motion(primitive.pose);
  const PreciseMatrix rotation = motion.rotation * turn(*primitive.bend);
  return outward_box(motion.translation + rotation * bent_box(*primitive.bend, primitive.superquadric));
}

bool is_empty(const Box& box) {
  return !std::ranges::equal(box.lower, box.upper, std::ranges::less_equal{});
}

/// `a` itself where the boxes have nothing in common.
Box common_part(const Box& a, const Box& b) {
  Box common = a;
  for (std::size_t i = 0; i < 3; ++i) {
    common.lower[i] = std::max(a.lower[i], b.lower[i]);
    common.upper[i] = std::min(a.upper[i], b.upper[i]);
  }
  return is_empty(common) ? a : common;
}

}  // namespace

Box hull(const Box& a, const Box& b) {
  Box both = a;
  for (std::size_t i = 0; i < 3; ++i) {
    both.lower[i] = std::min(a.lower[i], b.lower[i]);
    both.upper[i] = std::max(a.upper[i], b.upper[i]);
  }
  return both;
}

Box bounding_box(const SetExpression& expression, const BoxOfPrimitive& box_of_primitive) {
  if (expression.operands.empty()) return box_of_primitive(expression.primitive);
  Box box = bounding_box(expression.operands.front(), box_of_primitive);
  if (expression.operation == SetOperation::subtract) return box;
  for (const SetExpression& operand : std::span(expression.operands).subspan(1)) {
    const Box other = bounding_box(operand, box_of_primitive);
    box = expression.operation == SetOperation::unite ? hull(box, other) : common_part(box, other);
  }
  return box;
}

Box bounding_box(const Model& model) {
  if (model.csg) {
    return bounding_box(*model.csg, [&](std::uint32_t primitive) { return box_of(model.primitives.at(primitive)); });
  }
  Box box = box_of(model.primitives.front());
  for (const Primitive& primitive : std::span(model.primitives).subspan(1)) box = hull(box, box_of(primitive));
  return box;
}

}  // namespace verisq::verify

namespace verisq {

double bounding_radius(const Model& model) {
  using namespace verify;
  require_valid_with_meshes(model);
  const Box box = bounding_box(model);
  PreciseVector diagonal;
  for (std::size_t i = 0; i < 3; ++i) {
    diagonal[i] = PreciseInterval(Real(box.upper[i])) - PreciseInterval(Real(box.lower[i]));
  }
  return (length<Real>(diagonal) / PreciseInterval(2)).upper().to_double(Direction::up);
}

}  // namespace verisq

namespace verisq::verify {

SolidExtent extent_of(const Model& model) {
  const Box box = bounding_box(model);
  Point centre{};
  for (std::size_t i = 0; i < 3; ++i) centre[i] = 0.5 * box.lower[i] + 0.5 * box.upper[i];
  return {centre, bounding_radius(model)};
}

namespace {

using Plain = Coordinates<double>;

Plain about(const PreciseVector& x) {
  const Proposal middle = midpoint(x);
  return {static_cast<double>(middle[0]), static_cast<double>(middle[1]), static_cast<double>(middle[2])};
}

}  // namespace

HalfSpaceBound::HalfSpaceBound(const Model& model) {
  for (const Primitive& primitive : model.primitives) {
    const Superquadric& solid = primitive.superquadric;
    solids_.push_back({PosedSuperquadric(primitive), NearestNormal(solid), SuperquadricSet<double>(solid)});
  }
}

/// The normal of the surface where it is nearest to the centroid, or that of the triangle.
double HalfSpaceBound::lower(const Solid& solid, const Triangle& triangle) {
  const PosedTriangle posed(triangle, solid.posed.motion());
  TriangleSet<double> set{};
  std::ranges::transform(posed.corners(), set.corners.begin(), about);
  const auto& [a, b, c] = set.corners;
  BestNormal best(solid.set, set);
  best.offer(
      solid.nearest({(a[0] + b[0] + c[0]) / 3.0, (a[1] + b[1] + c[1]) / 3.0, (a[2] + b[2] + c[2]) / 3.0}).normal);
  best.offer_normals_of(set.corners);
  const Plain& n = best.normal();
  return lower_by_normal(solid.posed, posed, {n[0], n[1], n[2]});
}

/// Let every point of the triangle lie at least m > 0 away from all primitives but K, and less than m deep in K. A ball
/// about such a point in the union, of a radius of at most m, lies in K. So the point lies in the union no deeper than
/// in K.
double HalfSpaceBound::operator()(const Triangle& triangle) const {
  double least = infinity;        // of the solids that contain no point
  std::optional<double> entered;  // of the solid that may contain some
  for (const Solid& solid : solids_) {
    const double by_sphere = lower_by_sphere(solid.posed, triangle);
    const bool far = PreciseInterval(Real(by_sphere)).lower() > solid.posed.radius().upper();
    const double bound = far ? by_sphere : lower(solid, triangle);
    if (bound > 0.0) {
      least = std::min(least, bound);
    } else {
      if (entered) return -infinity;
      entered = bound;
    }
  }
  if (!entered) return least;
  return -*entered < least ? *entered : -infinity;
}

}  // namespace verisq::verify
