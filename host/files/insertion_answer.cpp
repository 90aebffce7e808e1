/// Rows are read one by one; what proves them need not prove anything.
#include "host/files/insertion_answer.hpp"

#include <fmt/format.h>

#include "host/files/certificate_fields.hpp"
#include "host/files/subject_file.hpp"

namespace verisq {
namespace {

/// So that no more work can be asked for than a row is worth.
constexpr std::size_t most_parts = 4096;

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

}  // namespace

InsertionAnswer read_insertion(const JsonValue& root) {
  root.check_keys({"format", "kind", "models", "mesh", "units", "pose", "path", "rows"});
  const JsonValue models = root.at("models");
  if (models.size() != 1) models.fail("must be an array of one model");
  InsertionAnswer answer{.model = read_subject_file(models.element(0)),
                         .mesh = read_subject_file(root.at("mesh")),
                         .units = units_of(root),
                         .pose = {},
                         .path = read_path(root.at("path")),
                         .rows = {}};
  if (const auto pose = root.find("pose")) answer.pose = read_pose_object(*pose);
  const JsonValue rows = root.at("rows");
  if (rows.size() == 0) rows.fail("must not be empty");
  answer.rows.reserve(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) answer.rows.push_back(read_row(rows.element(i)));
  return answer;
}

}  // namespace verisq
