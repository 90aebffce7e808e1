/// The messages for all that is no length.
#include "host/command_line/length_option.hpp"

#include <fmt/core.h>

#include <optional>

#include "host/command_line/finite_number.hpp"
#include "host/errors/refusal.hpp"

namespace verisq::command_line {

double parse_length(std::string_view option, const std::string& text) {
  const std::optional<double> value = finite_number(text);
  if (!value || *value < 0.0) refuse(fmt::format("{}: {} is not a finite number of at least 0", option, text));
  return *value;
}

double parse_positive_length(std::string_view option, const std::string& text) {
  const double length = parse_length(option, text);
  if (length == 0.0) refuse(fmt::format("{}: {} is not above 0", option, text));
  return length;
}

}  // namespace verisq::command_line
