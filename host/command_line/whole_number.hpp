/// Options whose values are whole numbers: a message with the limits for all that is none.
#pragma once

#include <concepts>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

namespace verisq::command_line {

/// Decimal digits, leading zeros allowed. Throws Error(input) that begins with `option` unless `text` is a whole number
/// of at least `least` and at most `most`.
[[nodiscard]] std::uint64_t parse_whole_number(std::string_view option, std::string_view text, std::uint64_t least,
                                               std::uint64_t most);

/// The kind of option whose value lies between these limits, which are not negative.
template <std::integral Number>
[[nodiscard]] auto whole_number(Number least, Number most = std::numeric_limits<Number>::max()) {
  return [least, most](std::string_view option, std::string_view text) {
    return static_cast<Number>(
        parse_whole_number(option, text, static_cast<std::uint64_t>(least), static_cast<std::uint64_t>(most)));
  };
}

}  // namespace verisq::command_line
