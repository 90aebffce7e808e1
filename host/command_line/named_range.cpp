/// The name, then two numbers.
#include "host/command_line/named_range.hpp"

#include <fmt/core.h>

#include <vector>

#include "host/command_line/number_list.hpp"
#include "host/errors/refusal.hpp"

namespace verisq::command_line {

NamedRange parse_named_range(std::string_view option, const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) refuse(fmt::format("{}: {} is not NAME=LO,HI", option, text));
  const std::string whole = fmt::format("{} {}", option, text);
  const std::vector<double> ends = parse_numbers(whole, text.substr(equals + 1), "LO,HI");
  if (ends[0] > ends[1]) refuse(fmt::format("{}: {} is above {}", whole, ends[0], ends[1]));
  return {text.substr(0, equals), {ends[0], ends[1]}};
}

}  // namespace verisq::command_line
