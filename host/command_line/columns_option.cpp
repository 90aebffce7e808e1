/// Names between commas.
#include "host/command_line/columns_option.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "host/errors/refusal.hpp"

namespace verisq::command_line {
namespace {

/// What may stand between commas: one column, or both ends of all coordinates of a box.
struct ColumnName {
  std::string_view name;
  std::vector<MapColumn> columns;
};

std::vector<MapColumn> from_to(MapColumn first, MapColumn last) {
  std::vector<MapColumn> columns;
  for (int k = static_cast<int>(first); k <= static_cast<int>(last); ++k) columns.push_back(static_cast<MapColumn>(k));
  return columns;
}

std::vector<ColumnName> all_names() {
  std::vector<ColumnName> names;
  for (const MapColumn column : from_to(MapColumn::index, MapColumn::unique)) {
    names.push_back({to_string(column), {column}});
  }
  names.push_back({"closest", from_to(MapColumn::closest_x_lo, MapColumn::closest_z_hi)});
  names.push_back({"normal", from_to(MapColumn::normal_x_lo, MapColumn::normal_z_hi)});
  names.push_back({to_string(MapColumn::primitive), {MapColumn::primitive}});
  return names;
}

std::vector<MapColumn> columns_named(std::string_view option, std::string_view name) {
  std::string known;
  for (const ColumnName& candidate : all_names()) {
    if (candidate.name == name) return candidate.columns;
    known += fmt::format("{}{}", known.empty() ? "" : ", ", candidate.name);
  }
  refuse(fmt::format("{}: '{}' is not one of {}", option, name, known));
}

}  // namespace

std::vector<MapColumn> parse_columns(std::string_view option, const std::string& text) {
  std::vector<MapColumn> columns;
  std::string_view rest = text;
  for (bool more = true; more;) {
    const std::size_t comma = rest.find(',');
    const std::string_view name = rest.substr(0, comma);
    for (const MapColumn column : columns_named(option, name)) {
      if (std::ranges::find(columns, column) != columns.end()) {
        refuse(fmt::format("{}: {} is there twice", option, name));
      }
      columns.push_back(column);
    }
    more = comma != std::string_view::npos;
    if (more) rest.remove_prefix(comma + 1);
  }
  return columns;
}

}  // namespace verisq::command_line
