/// The message for all that is no time.
#include "host/command_line/time_limit.hpp"

#include <fmt/core.h>

#include <verisq/error.hpp>

#include "host/command_line/finite_number.hpp"

namespace verisq::command_line {

std::optional<double> parse_time_limit(const std::optional<std::string>& text) {
  if (!text) return std::nullopt;
  const std::optional<double> seconds = finite_number(*text);
  if (!seconds || !(*seconds > 0.0)) {
    throw Error(ErrorKind::input, fmt::format("--time-limit: {} is not a finite number of seconds above 0", *text));
  }
  return seconds;
}

}  // namespace verisq::command_line
