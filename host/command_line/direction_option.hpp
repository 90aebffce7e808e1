/// Options whose value is a direction: --along, --up.
#pragma once

#include <string>
#include <string_view>
#include <verisq/mesh.hpp>

namespace verisq::command_line {

/// "x,y,z", each the nearest binary64, of any length but zero. Throws Error(input) that begins with `option` for
/// anything else.
[[nodiscard]] Point parse_direction(std::string_view option, const std::string& text);

}  // namespace verisq::command_line
