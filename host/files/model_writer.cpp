/// Writes `verisq-model/1`: numbers with as many digits as their binary64 needs, one primitive a paragraph.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <verisq/model_file.hpp>

#include "host/files/output_file.hpp"

namespace verisq {
namespace {

/// JSON on one line; nlohmann-json writes numbers so that they are read back as the same binary64, -0.0 too. Bytes that
/// are not UTF-8 cannot be in JSON: replaced rather than refused.
std::string text(const nlohmann::json& value) {
  return value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string text(const Primitive& primitive) {
  const auto& [semi_axes, exponents, taper] = primitive.superquadric;
  const std::string tapered = is_tapered(primitive.superquadric) ? fmt::format(R"(, "taper": {})", text(taper)) : "";
  std::string result = fmt::format(R"(    {{ "name": {},
      "superquadric": {{ "semi_axes": {}, "exponents": {}{} }})",
                                   text(primitive.name), text(semi_axes), text(exponents), tapered);
  if (primitive.bend) {
    result += fmt::format(R"(,
      "bend": {{ "curvature": {}, "angle_deg": {} }})",
                          text(primitive.bend->curvature), text(primitive.bend->angle_degrees));
  }
  return result + fmt::format(R"(,
      "pose": {{ "translation": {}, "quaternion": {} }} }})",
                              text(primitive.pose.translation), text(primitive.pose.quaternion));
}

std::string_view key(SetOperation operation) {
  switch (operation) {
    case SetOperation::unite: return "union";
    case SetOperation::intersect: return "intersection";
    case SetOperation::subtract: break;
  }
  return "difference";
}

std::string text(const SetExpression& expression, const Model& model) {
  if (expression.operands.empty()) return text(model.primitives[expression.primitive].name);
  std::string operands;
  for (const SetExpression& operand : expression.operands) {
    operands += (operands.empty() ? "" : ", ") + text(operand, model);
  }
  return fmt::format(R"({{ "{}": [{}] }})", key(expression.operation), operands);
}

/// The format wants an operator at the top: a primitive alone is the union of itself.
SetExpression with_operator(const SetExpression& expression) {
  if (!expression.operands.empty()) return expression;
  return {.operands = {expression}, .operation = SetOperation::unite};
}

std::string text(const FemurLandmarks& landmarks) {
  std::string points;
  for (const auto& [name, point] : named_landmarks) {
    if (const std::optional<Point>& at = landmarks.*point)
      points += fmt::format("{}\n    \"{}\": {}", points.empty() ? "" : ",", name, text(*at));
  }
  return points;
}

std::string text(const Model& model, const FemurLandmarks& landmarks) {
  std::string primitives;
  for (const Primitive& primitive : model.primitives) {
    primitives += (primitives.empty() ? "" : ",\n") + text(primitive);
  }
  std::string result = R"({ "format": "verisq-model/1")";
  if (!model.units.empty()) result += fmt::format(R"(, "units": {})", text(model.units));
  result += ",\n  \"primitives\": [\n" + primitives + " ]";
  if (model.csg) result += ",\n  \"csg\": " + text(with_operator(*model.csg), model);
  if (const std::string points = text(landmarks); !points.empty()) result += ",\n  \"landmarks\": {" + points + " }";
  return result + " }\n";
}

}  // namespace

void write_model(const std::filesystem::path& path, const Model& model) {
  write_model(path, model, {});
}

void write_model(const std::filesystem::path& path, const Model& model, const FemurLandmarks& landmarks) {
  OutputFile file(path);
  file.write(text(model, landmarks));
  file.finish();
}

}  // namespace verisq
