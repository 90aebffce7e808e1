/// Names between commas.
#include "host/command_line/columns_option.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "host/command_line/refusal.hpp"

namespace verisq::command_line {
namespace {

constexpr std::array all_columns{MapColumn::index, MapColumn::x,   MapColumn::y,     MapColumn::z,     MapColumn::lo,
                                 MapColumn::hi,    MapColumn::mid, MapColumn::width, MapColumn::status};

MapColumn column_named(std::string_view option, std::string_view name) {
  std::string known;
  for (const MapColumn column : all_columns) {
    if (to_string(column) == name) return column;
    known += fmt::format("{}{}", known.empty() ? "" : ", ", to_string(column));
  }
  refuse(fmt::format("{}: '{}' is not one of {}", option, name, known));
}

}  // namespace

std::vector<MapColumn> parse_columns(std::string_view option, const std::string& text) {
  std::vector<MapColumn> columns;
  std::string_view rest = text;
  for (bool more = true; more;) {
    const std::size_t comma = rest.find(',');
    const MapColumn column = column_named(option, rest.substr(0, comma));
    if (std::ranges::find(columns, column) != columns.end()) {
      refuse(fmt::format("{}: {} is there twice", option, to_string(column)));
    }
    columns.push_back(column);
    more = comma != std::string_view::npos;
    if (more) rest.remove_prefix(comma + 1);
  }
  return columns;
}

}  // namespace verisq::command_line
