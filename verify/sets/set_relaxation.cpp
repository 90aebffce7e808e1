/// Unions take the least bound, intersections the greatest.
#include "verify/sets/set_relaxation.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

/// That operands inherit. Three planes make a corner; a few more let them change within the cube.
constexpr std::size_t kMostInheritedCuts = 16;

}  // namespace

HalfSpace SetRelaxation::half_space(const SetNode& leaf) const {
  HalfSpace result = primitives_[leaf.primitive].half_space(cube_, leaf.side);
  const Point& n = result.normal;
  if (margin_ != 0.0) result.offset -= margin_ * std::hypot(n[0], n[1], n[2]);
  return result;
}

PolytopeDistance SetRelaxation::distance(const SetNode& node, std::vector<HalfSpace> cuts) const {
  if (node.kind == SetNode::Kind::union_of) return union_distance(node, cuts);
  if (node.kind == SetNode::Kind::intersection_of) return intersection_distance(node, std::move(cuts));
  cuts.push_back(half_space(node));
  PolytopeDistance result = polytope_distance(x_, cube_, cuts);
  result.lower = std::max(result.lower, leaf_bound_(node));
  return result;
}

PolytopeDistance SetRelaxation::union_distance(const SetNode& node, const std::vector<HalfSpace>& cuts) const {
  PolytopeDistance nearest = distance(node.operands.front(), cuts);
  for (const SetNode& operand : std::span(node.operands).subspan(1)) {
    const PolytopeDistance other = distance(operand, cuts);
    if (other.lower < nearest.lower) nearest = other;
  }
  return nearest;
}

void SetRelaxation::keep_farthest(std::vector<HalfSpace>& cuts) const {
  if (cuts.size() <= kMostInheritedCuts) return;
  const auto excess = [&](const HalfSpace& cut) {
    const Point& n = cut.normal;
    double along = 0.0;
    for (std::size_t i = 0; i < 3; ++i) along += n[i] * (x_[i] - cube_.centre[i]);
    const double far = (along - cut.offset) / std::hypot(n[0], n[1], n[2]);
    return std::isnan(far) ? -infinity : far;
  };
  std::ranges::nth_element(cuts, cuts.begin() + kMostInheritedCuts, std::ranges::greater{}, excess);
  cuts.resize(kMostInheritedCuts);
}

PolytopeDistance SetRelaxation::intersection_distance(const SetNode& node, std::vector<HalfSpace> cuts) const {
  double proven = 0.0;
  bool leaves_only = true;
  for (const SetNode& operand : node.operands) {
    if (operand.kind == SetNode::Kind::leaf) {
      cuts.push_back(half_space(operand));
      proven = std::max(proven, leaf_bound_(operand));
    } else {
      leaves_only = false;
    }
  }
  PolytopeDistance farthest{0.0, cube_.centre};
  if (leaves_only) farthest = polytope_distance(x_, cube_, cuts);
  if (!leaves_only) keep_farthest(cuts);
  for (const SetNode& operand : node.operands) {
    if (operand.kind == SetNode::Kind::leaf) continue;
    const PolytopeDistance other = distance(operand, cuts);
    if (other.lower >= farthest.lower) farthest = other;
  }
  farthest.lower = std::max(farthest.lower, proven);
  return farthest;
}

}  // namespace verisq::verify
