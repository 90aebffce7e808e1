/// Rows are read one by one, cubes letter by letter; what proves anything need not do so.
#include "host/files/insertion_answer.hpp"

#include <fmt/format.h>

#include <string_view>

#include "host/files/certificate_fields.hpp"
#include "host/files/subject_file.hpp"

namespace verisq {
namespace {

/// So that no more work can be asked for than a row is worth.
constexpr std::size_t most_parts = 4096;

constexpr std::string_view letters_of_cubes = ".d";  // of CubeDivision

WayPart read_part(const JsonValue& value) {
  value.check_keys({"until", "segment", "normals", "escape", "witness", "cover"});
  const JsonValue segment = value.at("segment");
  if (segment.size() != 2) segment.fail("must be an array of two points");
  return {nonnegative_number(value.at("until")),
          {finite_numbers<3>(segment.element(0)), finite_numbers<3>(segment.element(1))},
          read_certificate(value)};
}

InsertionAnswer::Row read_row(const JsonValue& value) {
  value.check_keys({"lo", "hi", "deepest", "parts"});
  const JsonValue deepest = value.at("deepest");
  deepest.check_keys({"time", "normals", "escape", "witness", "cover"});
  InsertionAnswer::Row row{{value.at("lo").number_or_infinity(), value.at("hi").number_or_infinity()},
                           {nonnegative_number(deepest.at("time")), read_certificate(deepest), {}}};
  const JsonValue parts = value.at("parts");
  if (parts.size() > most_parts) parts.fail(fmt::format("must have no more than {} parts", most_parts));
  for (std::size_t i = 0; i < parts.size(); ++i) row.certificate.parts.push_back(read_part(parts.element(i)));
  return row;
}

BoneSide read_bone_side(const JsonValue& value) {
  const std::string side = value.text();
  if (side == "inside") return BoneSide::inside;
  if (side != "outside") value.fail("must be \"inside\" or \"outside\"");
  return BoneSide::outside;
}

Plane read_resection(const JsonValue& value) {
  value.check_keys({"point", "normal"});
  const Plane plane{finite_numbers<3>(value.at("point")), finite_numbers<3>(value.at("normal"))};
  if (plane.normal == Point{}) value.at("normal").fail("must not be zero");
  return plane;
}

RemovedVolumeCertificate read_cubes(const JsonValue& value) {
  value.check_keys({"centre", "half_width", "parts"});
  RemovedVolumeCertificate certificate{.centre = finite_numbers<3>(value.at("centre")),
                                       .half_width = nonnegative_number(value.at("half_width"))};
  const JsonValue parts = value.at("parts");
  const std::string text = parts.text();
  if (text.size() > most_cubes_of_certificate)
    parts.fail(fmt::format("must be no more than {} parts", most_cubes_of_certificate));
  certificate.cubes.reserve(text.size());
  for (const char letter : text) {
    const std::size_t index = letters_of_cubes.find(letter);
    if (index == std::string_view::npos) parts.fail("must consist of the letters d and .");
    certificate.cubes.push_back(static_cast<CubeDivision>(index));
  }
  return certificate;
}

RemovalAnswer read_removed(const JsonValue& value) {
  value.check_keys({"lo", "hi", "bone", "within", "resection", "cube"});
  RemovalAnswer removed{.bone = read_bone_side(value.at("bone")),
                        .within = {},
                        .resection = {},
                        .volume = {value.at("lo").number_or_infinity(), value.at("hi").number_or_infinity()},
                        .certificate = read_cubes(value.at("cube"))};
  if (const auto within = value.find("within")) removed.within = read_subject_file(*within);
  if (const auto resection = value.find("resection")) removed.resection = read_resection(*resection);
  return removed;
}

}  // namespace

InsertionAnswer read_insertion(const JsonValue& root) {
  root.check_keys({"format", "kind", "models", "mesh", "units", "pose", "path", "rows", "removed"});
  const JsonValue models = root.at("models");
  if (models.size() != 1) models.fail("must be an array of one model");
  InsertionAnswer answer{.model = read_subject_file(models.element(0)),
                         .mesh = read_subject_file(root.at("mesh")),
                         .units = units_of(root),
                         .pose = {},
                         .path = read_path(root.at("path")),
                         .rows = {}};
  if (const auto pose = root.find("pose")) answer.pose = read_pose_object(*pose);
  if (const auto removed = root.find("removed")) answer.removed = read_removed(*removed);
  const JsonValue rows = root.at("rows");
  if (rows.size() == 0 && !answer.removed) rows.fail("must not be empty without \"removed\"");
  answer.rows.reserve(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) answer.rows.push_back(read_row(rows.element(i)));
  return answer;
}

std::string text_of(const std::vector<CubeDivision>& cubes) {
  std::string text;
  text.reserve(cubes.size());
  for (const CubeDivision cube : cubes) text += letters_of_cubes[static_cast<std::size_t>(cube)];
  return text;
}

}  // namespace verisq
