/// The message for all that is no time.
#include "host/command_line/time_limit.hpp"

#include <fmt/core.h>

#include "host/command_line/finite_number.hpp"
#include "host/errors/refusal.hpp"

namespace verisq::command_line {

double parse_time_limit(std::string_view option, const std::string& text) {
  const std::optional<double> seconds = finite_number(text);
  if (!seconds || !(*seconds > 0.0)) {
    refuse(fmt::format("{}: {} is not a finite number of seconds above 0", option, text));
  }
  return *seconds;
}

}  // namespace verisq::command_line
