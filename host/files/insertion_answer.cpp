/// Rows are read one by one, cubes letter by letter; what proves anything need not do so.
#include "host/files/insertion_answer.hpp"

#include <fmt/format.h>

#include <string_view>
#include <utility>

#include "host/files/certificate_fields.hpp"
#include "host/files/subject_file.hpp"

namespace verisq {
namespace {

/// So that no more work can be asked for than a row is worth.
constexpr std::size_t most_parts = 4096;

constexpr std::string_view letters_of_cubes = ".d";    // of CubeDivision
constexpr std::string_view letters_of_cells = ".mqh";  // of WayCell

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

WayWitness read_witness(const JsonValue& value) {
  value.check_keys({"triangle", "weights", "time", "normals", "escape", "witness", "cover"});
  return {read_index(value.at("triangle")), finite_numbers<2>(value.at("weights")),
          nonnegative_number(value.at("time")), read_certificate(value)};
}

MovedCell read_moved(const JsonValue& value) {
  value.check_keys({"step", "normals"});
  return {finite_numbers<3>(value.at("step")), read_certificate(value).normals};
}

WayTriangle read_way_triangle(const JsonValue& value) {
  value.check_keys({"triangle", "cells", "moved"});
  WayTriangle triangle{read_index(value.at("triangle")), {}, {}};
  const JsonValue cells = value.at("cells");
  for (const char letter : cells.text()) {
    const std::size_t index = letters_of_cells.find(letter);
    if (index == std::string_view::npos) cells.fail("must consist of the letters m, q, h and .");
    triangle.cells.push_back(static_cast<WayCell>(index));
  }
  const JsonValue moved = value.at("moved");
  for (std::size_t i = 0; i < moved.size(); ++i) triangle.moved.push_back(read_moved(moved.element(i)));
  return triangle;
}

WaySurfaceAnswer read_way_surface(const JsonValue& value) {
  value.check_keys({"lo", "hi", "deepest", "triangles"});
  WaySurfaceAnswer surface{{value.at("lo").number_or_infinity(), value.at("hi").number_or_infinity()}, {}};
  if (const auto deepest = value.find("deepest")) surface.certificate.deepest = read_witness(*deepest);
  const JsonValue triangles = value.at("triangles");
  std::vector<WayTriangle>& all = surface.certificate.triangles;
  std::size_t cells = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    WayTriangle next = read_way_triangle(triangles.element(i));
    if (!all.empty() && next.triangle <= all.back().triangle)
      triangles.element(i).at("triangle").fail("must be above those before");
    cells += next.cells.size();
    all.push_back(std::move(next));
    if (cells > most_cells_of_way_surface)
      triangles.fail(fmt::format("must have no more than {} cells", most_cells_of_way_surface));
  }
  return surface;
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
  root.check_keys({"format", "kind", "models", "mesh", "units", "pose", "path", "rows", "surface", "removed"});
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
  if (const auto surface = root.find("surface")) {
    if (rows.size() == 0) surface->fail("must not be there without \"rows\"");
    answer.surface = read_way_surface(*surface);
  }
  if (rows.size() == 0 && !answer.removed) rows.fail("must not be empty without \"removed\"");
  answer.rows.reserve(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) answer.rows.push_back(read_row(rows.element(i)));
  return answer;
}

std::string text_of(const std::vector<WayCell>& cells) {
  std::string text;
  text.reserve(cells.size());
  for (const WayCell cell : cells) text += letters_of_cells[static_cast<std::size_t>(cell)];
  return text;
}

std::string text_of(const std::vector<CubeDivision>& cubes) {
  std::string text;
  text.reserve(cubes.size());
  for (const CubeDivision cube : cubes) text += letters_of_cubes[static_cast<std::size_t>(cube)];
  return text;
}

}  // namespace verisq
