/// Options whose values are lengths in model units: --tol, --point-radius.
#pragma once

#include <string>
#include <string_view>

namespace verisq::command_line {

/// The binary64 number nearest to `text`. Throws Error(input) that begins with `option` unless it is finite and at
/// least 0.
[[nodiscard]] double parse_length(std::string_view option, const std::string& text);

/// As `parse_length`, and not 0.
[[nodiscard]] double parse_positive_length(std::string_view option, const std::string& text);

}  // namespace verisq::command_line
