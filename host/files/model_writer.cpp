/// Models to files, and landmarks of femurs from and to them.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <verisq/features.hpp>
#include <verisq/files.hpp>

#include "host/files/input_file.hpp"
#include "host/files/json_document.hpp"
#include "host/files/model_file.hpp"
#include "host/files/output_file.hpp"
#include "verify/solids/model.hpp"

namespace verisq {
namespace {

/// JSON on one line; nlohmann-json writes numbers so that they are read back as the same binary64, -0.0 too. Bytes that
/// are not UTF-8 cannot be in JSON: replaced rather than refused.
std::string text(const nlohmann::json& value) {
  return value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string superquadric_text(const Primitive& primitive) {
  const auto& [semi_axes, exponents, taper] = primitive.superquadric;
  const std::string tapered = is_tapered(primitive.superquadric) ? fmt::format(R"(, "taper": {})", text(taper)) : "";
  return fmt::format(R"("superquadric": {{ "semi_axes": {}, "exponents": {}{} }})", text(semi_axes), text(exponents),
                     tapered);
}

std::string text(const Primitive& primitive) {
  std::string result = fmt::format("    {{ \"name\": {},\n      ", text(primitive.name));
  result += primitive.mesh ? fmt::format(R"("mesh": {{ "vertices": {}, "triangles": {} }})",
                                         text(primitive.mesh->vertices), text(primitive.mesh->triangles))
                           : superquadric_text(primitive);
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
  verify::require_valid_with_meshes(model);
  OutputFile file(path);
  file.write(text(model, landmarks));
  file.finish();
}

namespace {

constexpr std::string_view format_name = "verisq-landmarks/1";

}  // namespace

LandmarkFile parse_landmarks(std::string_view json, std::string_view name) {
  const nlohmann::json document = parse_json(json, name);
  const JsonValue root(document, name);
  if (!document.is_object()) root.fail("must be an object");
  if (const JsonValue format = root.at("format"); format.text() != format_name)
    format.fail(fmt::format("must be \"{}\"", format_name));
  root.check_keys({"format", "units", "side", "head_radius", "landmarks"});
  if (const auto units = root.find("units"); units && units->text() != "mm") units->fail("must be \"mm\"");
  LandmarkFile file{.landmarks = read_landmark_points(root.at("landmarks")), .side = read_side(root)};
  if (const auto radius = root.find("head_radius")) {
    file.landmarks.head_radius = radius->number();
    if (!(*file.landmarks.head_radius > 0.0)) radius->fail("must be positive");
  }
  return file;
}

LandmarkFile read_landmarks(const std::filesystem::path& path) {
  constexpr std::size_t largest = std::size_t{1} << 20;
  InputFile file(path);
  const std::string_view text = file.peek_text(largest + 1);
  if (text.size() > largest) file.fail_whole(fmt::format("larger than {} bytes: no landmarks", largest));
  return parse_landmarks(text, path.string());
}

void write_landmarks(const std::filesystem::path& path, const LandmarkFile& file) {
  nlohmann::ordered_json document{{"format", format_name}, {"units", "mm"}};
  if (file.side) document["side"] = *file.side == Side::left ? "left" : "right";
  if (file.landmarks.head_radius) document["head_radius"] = *file.landmarks.head_radius;
  document["landmarks"] = nlohmann::ordered_json::object();
  for (const auto& [name, point] : named_landmarks) {
    if (const std::optional<Point>& at = file.landmarks.*point) document["landmarks"][name] = *at;
  }
  OutputFile out(path);
  out.write(document.dump(2) + "\n");
  out.finish();
}

}  // namespace verisq
