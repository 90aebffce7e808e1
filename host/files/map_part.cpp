/// Which rows a part has, and the format `verisq-part/1` beside it: docs/formats.md §10.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <verisq/map_part.hpp>
#include <verisq/version.hpp>

#include "host/files/input_file.hpp"
#include "host/files/json_document.hpp"
#include "host/files/output_file.hpp"
#include "host/files/sha256.hpp"
#include "host/files/subject_file.hpp"

namespace verisq {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr std::string_view part_format = "verisq-part/1";

/// As of a model file.
constexpr std::size_t largest_part_file = std::size_t{1} << 26;

std::string_view word_of(MapElements elements) {
  switch (elements) {
    case MapElements::vertices: return "points";
    case MapElements::triangles: return "triangles";
    case MapElements::poses: break;
  }
  return "poses";
}

OrderedJson json_of_subject(const SubjectFile& file) {
  return {{"file", file.name}, {"sha256", file.sha256}};
}

/// Of no rows the smallest distance is infinite, of unbounded ones the width.
OrderedJson json_of_number(double number) {
  if (std::isfinite(number)) return number;
  return number > 0.0 ? "inf" : "-inf";
}

OrderedJson json_of_summary(const MapPart& part) {
  const MapSummary& summary = part.summary;
  OrderedJson json{{"device", summary.device},
                   {"device_verified", summary.device_verified},
                   {"host_verified", summary.host_verified},
                   {"wide", summary.wide},
                   {"wide_inside", summary.wide_inside},
                   {"smallest_lo", json_of_number(summary.minimum_lo)},
                   {"smallest_hi", json_of_number(summary.minimum_hi)},
                   {"largest_width", json_of_number(summary.largest_width)},
                   {"device_seconds", summary.device_seconds},
                   {"host_seconds", summary.host_seconds}};
  if (part.closest) {
    json["unique_closest_points"] = part.closest->unique;
    json["widest_closest_point"] = json_of_number(part.closest->widest_point);
    json["widest_normal"] = json_of_number(part.closest->widest_normal);
  }
  return json;
}

std::uint64_t whole_number(const JsonValue& value) {
  if (!value.json().is_number_unsigned()) value.fail("must be a whole number");
  return value.json().get<std::uint64_t>();
}

MapElements read_elements(const JsonValue& value) {
  const std::string word = value.text();
  for (const MapElements elements : {MapElements::vertices, MapElements::triangles, MapElements::poses}) {
    if (word == word_of(elements)) return elements;
  }
  value.fail("must be \"points\", \"triangles\" or \"poses\"");
}

std::vector<PartSetting> read_settings(const JsonValue& value) {
  if (!value.json().is_object()) value.fail("must be an object");
  std::vector<PartSetting> settings;
  for (const auto& [name, unused] : value.json().items()) settings.push_back({name, value.at(name).text()});
  return settings;
}

void read_summary(const JsonValue& value, MapPart& part) {
  value.check_keys({"device", "device_verified", "host_verified", "wide", "wide_inside", "smallest_lo", "smallest_hi",
                    "largest_width", "device_seconds", "host_seconds", "unique_closest_points", "widest_closest_point",
                    "widest_normal"});
  MapSummary& summary = part.summary;
  summary.device = value.at("device").text();
  summary.points = part.rows.count;
  summary.device_verified = whole_number(value.at("device_verified"));
  summary.host_verified = whole_number(value.at("host_verified"));
  summary.wide = whole_number(value.at("wide"));
  summary.wide_inside = whole_number(value.at("wide_inside"));
  summary.minimum_lo = value.at("smallest_lo").number_or_infinity();
  summary.minimum_hi = value.at("smallest_hi").number_or_infinity();
  summary.largest_width = value.at("largest_width").number_or_infinity();
  summary.device_seconds = value.at("device_seconds").number();
  summary.host_seconds = value.at("host_seconds").number();
  if (summary.device_verified + summary.host_verified + summary.wide != part.rows.count) {
    value.at("wide").fail("the counts must add up to the rows");
  }
  if (const auto unique = value.find("unique_closest_points")) {
    part.closest = ClosestPointSummary{.points = part.rows.count,
                                       .unique = whole_number(*unique),
                                       .widest_point = value.at("widest_closest_point").number_or_infinity(),
                                       .widest_normal = value.at("widest_normal").number_or_infinity()};
  }
}

MapPart parse_map_part(std::string_view text, std::string_view name) {
  const nlohmann::json document = parse_json(text, name);
  const JsonValue root(document, name);
  if (!root.json().is_object()) root.fail("must be an object");
  if (const JsonValue format = root.at("format"); format.text() != part_format) {
    format.fail(fmt::format("must be \"{}\"", part_format));
  }
  root.check_keys(
      {"format", "version", "part", "parts", "rows", "map", "models", "elements", "input", "settings", "summary"});
  MapPart part;
  part.version = root.at("version").text();
  part.part = whole_number(root.at("part"));
  part.parts = whole_number(root.at("parts"));
  if (part.part == 0 || part.part > part.parts) root.at("part").fail("must be from 1 to the number of parts");
  const JsonValue rows = root.at("rows");
  rows.check_keys({"first", "count", "in_all"});
  part.rows = {whole_number(rows.at("first")), whole_number(rows.at("count"))};
  part.rows_in_all = whole_number(rows.at("in_all"));
  if (part.rows != rows_of_part(part.part, part.parts, part.rows_in_all)) {
    rows.at("first").fail(fmt::format("these are not the rows of part {} of {}", part.part, part.parts));
  }
  part.map = read_subject_file(root.at("map"));
  const JsonValue models = root.at("models");
  for (std::size_t i = 0; i < models.size(); ++i) part.models.push_back(read_subject_file(models.element(i)));
  part.elements = read_elements(root.at("elements"));
  part.input = read_subject_file(root.at("input"));
  part.settings = read_settings(root.at("settings"));
  read_summary(root.at("summary"), part);
  return part;
}

}  // namespace

RowRange rows_of_part(std::uint64_t part, std::uint64_t parts, std::uint64_t rows) {
  const std::uint64_t blocks = rows / rows_per_block + (rows % rows_per_block != 0 ? 1 : 0);
  const std::uint64_t each = blocks / parts;
  const std::uint64_t more = blocks % parts;  // so many parts have one more
  const auto start = [&](std::uint64_t before) {
    return std::min((before * each + std::min(before, more)) * rows_per_block, rows);
  };
  return {start(part - 1), start(part) - start(part - 1)};
}

std::filesystem::path part_file_of(const std::filesystem::path& map) {
  std::filesystem::path path = map;
  path += ".part.json";
  return path;
}

SubjectFile digest_of_file(const std::filesystem::path& path) {
  if (!std::filesystem::is_regular_file(path)) {
    InputFile(path).fail_whole("no regular file, which parts of a map must be of");
  }
  return subject_file(path);
}

void write_map_part(const std::filesystem::path& map, const MapPart& part) {
  OrderedJson document{{"format", part_format}, {"version", part.version}, {"part", part.part}, {"parts", part.parts}};
  document["rows"] = {{"first", part.rows.first}, {"count", part.rows.count}, {"in_all", part.rows_in_all}};
  document["map"] = json_of_subject(part.map);
  document["models"] = OrderedJson::array();
  for (const SubjectFile& model : part.models) document["models"].push_back(json_of_subject(model));
  document["elements"] = word_of(part.elements);
  document["input"] = json_of_subject(part.input);
  document["settings"] = OrderedJson::object();
  for (const auto& [name, value] : part.settings) document["settings"][name] = value;
  document["summary"] = json_of_summary(part);
  OutputFile file(part_file_of(map));
  file.write(document.dump(2, ' ', false, OrderedJson::error_handler_t::replace) + "\n");
  file.finish();
}

MapPart read_map_part(const std::filesystem::path& map) {
  InputFile file(part_file_of(map));
  const std::string_view text = file.peek(largest_part_file + 1);
  if (text.size() > largest_part_file) {
    file.fail_whole(fmt::format("larger than {} bytes: not what stands beside a part", largest_part_file));
  }
  return parse_map_part(text, file.name());
}

}  // namespace verisq
