/// Levels go through unions as least, through intersections as greatest values; far primitives cost a distance.
#include "host/tessellation/solid.hpp"

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>

namespace verisq::tessellation {
namespace {

/// Of the line that is searched for the surface.
constexpr double fraction_precision = 1e-12;

template <class InPrimitive>
bool in_set(const SetExpression& set, const InPrimitive& in_primitive) {
  if (set.operands.empty()) return in_primitive(set.primitive);
  const auto in_operand = [&](const SetExpression& operand) { return in_set(operand, in_primitive); };
  switch (set.operation) {
    case SetOperation::unite: return std::ranges::any_of(set.operands, in_operand);
    case SetOperation::intersect: return std::ranges::all_of(set.operands, in_operand);
    case SetOperation::subtract: break;
  }
  return in_operand(set.operands.front()) && std::none_of(set.operands.begin() + 1, set.operands.end(), in_operand);
}

template <class LevelOf>
Solid::Level level_of_set(const SetExpression& set, const LevelOf& level_of) {
  if (set.operands.empty()) return level_of(set.primitive);
  Solid::Level result = level_of_set(set.operands.front(), level_of);
  for (std::size_t i = 1; i < set.operands.size(); ++i) {
    Solid::Level operand = level_of_set(set.operands[i], level_of);
    if (set.operation == SetOperation::subtract) operand.value = -operand.value;
    const bool decides =
        set.operation == SetOperation::unite ? operand.value < result.value : operand.value > result.value;
    if (decides) result = operand;
  }
  return result;
}

}  // namespace

Solid::Solid(const Model& model) : model_(model) {
  for (const Primitive& primitive : model.primitives) primitives_.emplace_back(primitive);
}

bool Solid::contains(const Eigen::Vector3d& point) const {
  return contains(point, primitives_.size(), false);
}

bool Solid::contains(const Eigen::Vector3d& point, std::size_t k, bool in_k) const {
  const auto in_primitive = [&](std::size_t i) {
    if (i == k) return in_k;
    const PlacedPrimitive& primitive = primitives_[i];
    const double radius = primitive.radius();
    return (point - primitive.centre()).squaredNorm() <= radius * radius && primitive.contains(point);
  };
  if (model_.csg) return in_set(*model_.csg, in_primitive);
  for (std::size_t i = 0; i < primitives_.size(); ++i) {
    if (in_primitive(i)) return true;
  }
  return false;
}

Solid::Level Solid::level(const Eigen::Vector3d& point) const {
  const auto level_of = [&](std::size_t i) {
    const PlacedPrimitive& primitive = primitives_[i];
    const double beyond = (point - primitive.centre()).norm() - primitive.radius();
    return Level{beyond > 0.0 ? beyond + primitive.smallest_semi_axis() : primitive.level(point), i};
  };
  if (model_.csg) return level_of_set(*model_.csg, level_of);
  Level least = level_of(0);
  for (std::size_t i = 1; i < primitives_.size(); ++i) {
    const Level other = level_of(i);
    if (other.value < least.value) least = other;
  }
  return least;
}

Eigen::Vector3d Solid::outward(const Eigen::Vector3d& point, double step) const {
  Eigen::Vector3d gradient;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d offset = step * Eigen::Vector3d::Unit(axis);
    gradient[axis] = level(point + offset).value - level(point - offset).value;
  }
  return gradient.stableNormalized();
}

double Solid::crossing(const Eigen::Vector3d& inside, const Eigen::Vector3d& outside) const {
  const auto level_at = [&](double t) { return level(inside + t * (outside - inside)).value; };
  const double first = level_at(0.0);
  const double last = level_at(1.0);
  if (!(first < 0.0)) return 0.0;
  if (!(last > 0.0)) return 1.0;
  const auto precise = [](double a, double b) { return b - a <= fraction_precision; };
  std::uintmax_t evaluations = 100;
  const auto [a, b] = boost::math::tools::toms748_solve(level_at, 0.0, 1.0, first, last, precise, evaluations);
  return (a + b) / 2.0;
}

std::optional<Eigen::Vector3d> Solid::surface_along(const Eigen::Vector3d& point, const Eigen::Vector3d& outward,
                                                    double reach) const {
  const Eigen::Vector3d inside = point - reach * outward;
  const Eigen::Vector3d outside = point + reach * outward;
  if (!contains(inside) || contains(outside)) return std::nullopt;
  return inside + crossing(inside, outside) * (outside - inside);
}

}  // namespace verisq::tessellation
