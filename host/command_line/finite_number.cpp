/// std::from_chars, which knows no locale and rounds to nearest.
#include "host/command_line/finite_number.hpp"

#include <charconv>
#include <cmath>
#include <system_error>

namespace verisq::command_line {

std::optional<double> finite_number(std::string_view text) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || rest != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace verisq::command_line
