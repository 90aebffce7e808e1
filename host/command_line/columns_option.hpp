/// --columns: which columns a map has, and their order.
#pragma once

#include <string>
#include <string_view>
#include <vector>
#include <verisq/map_file.hpp>

namespace verisq::command_line {

/// The columns named between the commas of `text`; `closest` and `normal` are six each. Throws Error(input) that begins
/// with `option` for other names and for one that is there twice.
[[nodiscard]] std::vector<MapColumn> parse_columns(std::string_view option, const std::string& text);

}  // namespace verisq::command_line
