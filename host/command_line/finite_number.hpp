/// Numbers in options, as typed.
#pragma once

#include <optional>
#include <string_view>

namespace verisq::command_line {

/// The binary64 number nearest to `text`; nothing unless all of it is one finite number.
[[nodiscard]] std::optional<double> finite_number(std::string_view text);

}  // namespace verisq::command_line
