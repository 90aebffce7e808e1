/// The message for all that is no length.
#include "host/command_line/length_option.hpp"

#include <fmt/core.h>

#include <optional>
#include <verisq/error.hpp>

#include "host/command_line/finite_number.hpp"

namespace verisq::command_line {

double parse_length(std::string_view option, const std::string& text) {
  const std::optional<double> value = finite_number(text);
  if (!value || *value < 0.0) {
    throw Error(ErrorKind::input, fmt::format("{}: {} is not a finite number of at least 0", option, text));
  }
  return *value;
}

}  // namespace verisq::command_line
