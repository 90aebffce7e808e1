/// Comparison, and the model as text.
#include "tests/oracle/solid_escape.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace verisq::oracle {

namespace {

[[nodiscard]] std::string primitive_json(const Primitive& p) {
  const std::string bend = p.bend ? fmt::format(R"("bend": {{"curvature": {:.17g}, "angle_deg": {:.17g}}}, )",
                                                p.bend->curvature, p.bend->angle_degrees)
                                  : "";
  const Superquadric& solid = p.superquadric;
  const std::string taper = is_tapered(solid) ? fmt::format(R"(, "taper": {:.17g})", solid.taper) : "";
  return fmt::format(R"({{"name": "{}", "superquadric": {{"semi_axes": [{:.17g}], "exponents": [{:.17g}]{}}}, {})"
                     R"("pose": {{"translation": [{:.17g}], "quaternion": [{:.17g}]}}}})",
                     p.name, fmt::join(solid.semi_axes, ", "), fmt::join(solid.exponents, ", "), taper, bend,
                     fmt::join(p.pose.translation, ", "), fmt::join(p.pose.quaternion, ", "));
}

[[nodiscard]] std::string tree_json(const Model& model, const SetExpression& expression) {
  if (expression.operands.empty()) return fmt::format(R"("{}")", model.primitives.at(expression.primitive).name);
  std::vector<std::string> operands;
  for (const SetExpression& operand : expression.operands) operands.push_back(tree_json(model, operand));
  constexpr std::array names{"union", "intersection", "difference"};
  return fmt::format(R"({{"{}": [{}]}})", names[static_cast<std::size_t>(expression.operation)],
                     fmt::join(operands, ", "));
}

}  // namespace

std::string model_json(const Model& model) {
  std::vector<std::string> primitives;
  for (const Primitive& p : model.primitives) primitives.push_back(primitive_json(p));
  const std::string csg = model.csg ? fmt::format(R"(, "csg": {})", tree_json(model, *model.csg)) : "";
  return fmt::format(R"({{"format": "verisq-model/1", "units": "{}", "primitives": [{}]{}}})", model.units,
                     fmt::join(primitives, ", "), csg);
}

std::optional<std::string> escape(const Enclosure& enclosure, const Model& model, const Point& point, const Real& lower,
                                  const Real& upper) {
  const auto evidence = [&](std::string_view what) {
    return fmt::format("{}: [{:.17g}, {:.17g}], reference [{}, {}]; point {:.17g}; model {}", what, enclosure.lo,
                       enclosure.hi, text(lower), text(upper), fmt::join(point, ","), model_json(model));
  };
  // A NaN end is no interval.
  if (!(enclosure.lo <= enclosure.hi)) return evidence("not an interval");
  if (Real(enclosure.hi) < lower) return evidence("upper end too low");
  if (Real(enclosure.lo) > upper) return evidence("lower end too high");
  return std::nullopt;
}

}  // namespace verisq::oracle
