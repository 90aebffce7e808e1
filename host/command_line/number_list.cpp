/// Splits at commas.
#include "host/command_line/number_list.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "host/command_line/finite_number.hpp"
#include "host/errors/refusal.hpp"

namespace verisq::command_line {

std::vector<double> parse_numbers(std::string_view option, std::string_view text, std::string_view names) {
  std::vector<double> numbers;
  std::string_view rest = text;
  for (bool more = true; more;) {
    const std::size_t comma = rest.find(',');
    const auto number = finite_number(rest.substr(0, comma));
    if (!number) refuse(fmt::format("{}: '{}' is not a finite number", option, rest.substr(0, comma)));
    numbers.push_back(*number);
    more = comma != std::string_view::npos;
    if (more) rest.remove_prefix(comma + 1);
  }
  const auto needed = static_cast<std::size_t>(std::ranges::count(names, ',') + 1);
  if (numbers.size() != needed) {
    refuse(
        fmt::format("{}: {} numbers where {} are needed: {} (given: {})", option, numbers.size(), needed, names, text));
  }
  return numbers;
}

}  // namespace verisq::command_line
