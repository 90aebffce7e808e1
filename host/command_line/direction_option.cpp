/// Three numbers as a direction.
#include "host/command_line/direction_option.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <vector>

#include "host/command_line/number_list.hpp"
#include "host/errors/refusal.hpp"

namespace verisq::command_line {

Point parse_direction(std::string_view option, const std::string& text) {
  const std::vector<double> numbers = parse_numbers(option, text, "x,y,z");
  const Point direction{numbers[0], numbers[1], numbers[2]};
  if (std::ranges::all_of(direction, [](double x) { return x == 0.0; })) {
    refuse(fmt::format("{}: {} is no direction", option, text));
  }
  return direction;
}

}  // namespace verisq::command_line
