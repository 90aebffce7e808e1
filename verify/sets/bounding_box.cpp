/// Boxes of the primitives, combined along the tree of set operations.
#include "verify/sets/bounding_box.hpp"

#include <algorithm>
#include <span>

#include "verify/search/convex_primitive.hpp"
#include "verify/sets/bend_range.hpp"
#include "verisq/signed_distance.hpp"

namespace verisq::verify {

namespace {

Box rounded_outward(const PreciseVector& x) {
  Box box{};
  for (std::size_t i = 0; i < 3; ++i) {
    const PreciseInterval& range = x[i];
    box.lower[i] = range.lower().to_double(Direction::down);
    box.upper[i] = range.upper().to_double(Direction::up);
  }
  return box;
}

Box box_of(const Primitive& primitive) {
  if (!is_bent(primitive)) return rounded_outward(ConvexPrimitive(primitive).bounding_box());
  const RigidMotion motion(primitive.pose);
  const PreciseMatrix rotation = motion.rotation * turn(*primitive.bend);
  return rounded_outward(motion.translation + rotation * bent_box(*primitive.bend, primitive.superquadric));
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
  const Box box = bounding_box(model);
  PreciseVector diagonal;
  for (std::size_t i = 0; i < 3; ++i) {
    diagonal[i] = PreciseInterval(Real(box.upper[i])) - PreciseInterval(Real(box.lower[i]));
  }
  return (length<Real>(diagonal) / PreciseInterval(2)).upper().to_double(Direction::up);
}

}  // namespace verisq
