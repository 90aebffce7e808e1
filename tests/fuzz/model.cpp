/// Fuzz target of parse_model, parse_uncertain_model, parse_areas and parse_model_landmarks.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <span>
#include <verisq/clearance.hpp>
#include <verisq/features.hpp>
#include <verisq/files.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

#include "tests/fuzz/landmark_promise.hpp"
#include "tests/fuzz/promise.hpp"
#include "tests/fuzz/targets.hpp"

namespace verisq::fuzz {
namespace {

void check_interval(const Enclosure& interval) {
  check(interval.lo <= interval.hi, "the lower end of an interval does not exceed the upper");
  check(std::isfinite(interval.lo) && std::isfinite(interval.hi), "numbers are finite");
}

void check_primitive(const UncertainPrimitive& primitive) {
  const auto& [name, semi_axes, exponents, translation, quaternion, bend, taper, mesh] = primitive;
  if (mesh) {
    check(!mesh->triangles.empty(), "a mesh has triangles");
    check(!bend && taper == 1.0, "a mesh is neither bent nor tapered");
    const std::size_t count = mesh->vertices.size();
    const auto exists = [count](std::uint32_t corner) { return corner < count; };
    for (const auto& triangle : mesh->triangles) check(std::ranges::all_of(triangle, exists), "corners exist");
    return;
  }
  for (const Enclosure& number : semi_axes) check_interval(number);
  for (const Enclosure& number : exponents) check_interval(number);
  for (const Enclosure& number : translation) check_interval(number);
  check(std::ranges::all_of(semi_axes, [](const Enclosure& a) { return 0.0 < a.lo; }), "semi-axes are positive");
  check(std::ranges::all_of(exponents, [](const Enclosure& e) { return 0.0 < e.lo && e.hi <= 2.0; }),
        "exponents are in (0, 2]");
  check(std::ranges::all_of(quaternion, [](double q) { return std::isfinite(q); }), "quaternions are finite");
  check(smallest_taper <= taper && taper <= largest_taper, "tapers are in their range");
  check(std::ranges::any_of(quaternion, [](double q) { return q != 0.0; }), "quaternions are not zero");
  if (!bend) return;
  check(std::isfinite(bend->curvature) && std::isfinite(bend->angle_degrees), "bends are finite");
  check(std::abs(bend->curvature) * semi_axes[2].hi < 3.1415926535897936, "bends turn by less than a full turn");
}

void check_expression(const SetExpression& expression, std::size_t primitives) {
  check(!expression.operands.empty() || expression.primitive < primitives, "operands are known");
  check(expression.operands.size() != 1 || expression.operation != SetOperation::subtract,
        "differences have two operands");
  for (const SetExpression& operand : expression.operands) check_expression(operand, primitives);
}

void check_model(const UncertainModel& model) {
  check(!model.primitives.empty(), "a model has primitives");
  std::set<std::string> names;
  for (const UncertainPrimitive& primitive : model.primitives) {
    check_primitive(primitive);
    check(names.insert(primitive.name).second, "names of primitives are distinct");
  }
  if (model.csg) check_expression(*model.csg, model.primitives.size());
  const auto bent = [](const UncertainPrimitive& primitive) {
    return primitive.bend && primitive.bend->curvature != 0.0;
  };
  const auto moves = [](const UncertainPrimitive& primitive) {
    return std::ranges::any_of(primitive.translation, [](const Enclosure& x) { return x.lo != x.hi; });
  };
  check(std::ranges::none_of(model.primitives, moves) || std::ranges::none_of(model.primitives, bent),
        "models of uncertain places are not bent");
  const auto tapered = [](const UncertainPrimitive& primitive) { return primitive.taper != 1.0; };
  check(is_exact(model) || std::ranges::none_of(model.primitives, tapered), "models with intervals are not tapered");
}

void check_areas(std::span<const AreaBox> areas) {
  std::set<std::string> names;
  for (const auto& [area, lower, upper] : areas) {
    check(!area.name.empty() && names.insert(area.name).second, "areas have distinct names");
    check(std::isfinite(area.weight) && area.weight >= 0.0, "weights are finite and not negative");
    for (std::size_t k = 0; k < 3; ++k) check_interval({lower[k], upper[k]});
  }
}

}  // namespace

void model(Bytes bytes) {
  const std::string name = "model.json";
  const std::string json(bytes.begin(), bytes.end());  // a copy, so that reading past its end shows
  read_or_refuse(name, [&] { check_model(parse_uncertain_model(json, name)); });
  read_or_refuse(name, [&] { check_model(parse_model(json, name)); });
  read_or_refuse(name, [&] { check_areas(parse_areas(json, name)); });
  read_or_refuse(name, [&] { check_landmarks(parse_model_landmarks(json, name)); });
}

}  // namespace verisq::fuzz
