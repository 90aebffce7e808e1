/// std::from_chars and the message for all else.
#include "host/command_line/length_option.hpp"

#include <fmt/core.h>

#include <charconv>
#include <cmath>
#include <system_error>
#include <verisq/error.hpp>

namespace verisq::command_line {

double parse_length(std::string_view option, const std::string& text) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  const bool is_number = error == std::errc() && rest == end;
  if (!is_number || !std::isfinite(value) || value < 0.0) {
    throw Error(ErrorKind::input, fmt::format("{}: {} is not a finite number of at least 0", option, text));
  }
  return value;
}

}  // namespace verisq::command_line
