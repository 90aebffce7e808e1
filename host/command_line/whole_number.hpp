/// Options whose values are whole numbers: a message with the limits for all that is none.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <limits>
#include <string>

namespace verisq::command_line {

/// For CLI::Option::transform, before the text is converted to a type that may be too small for it: decimal, without
/// leading zeros, which CLI11 would read as octal. Throws Error(input) that begins with `option` unless the text is a
/// whole number of at least `least` and at most `most`.
[[nodiscard]] CLI::Validator whole_number(std::string option, std::int64_t least,
                                          std::uint64_t most = std::numeric_limits<std::uint64_t>::max());

}  // namespace verisq::command_line
