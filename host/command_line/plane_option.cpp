/// Six numbers as a plane.
#include "host/command_line/plane_option.hpp"

#include <fmt/core.h>

#include <vector>

#include "host/command_line/number_list.hpp"
#include "host/errors/refusal.hpp"

namespace verisq::command_line {

Plane parse_plane(std::string_view option, const std::string& text) {
  const std::vector<double> numbers = parse_numbers(option, text, "x,y,z,nx,ny,nz");
  const Plane plane{{numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5]}};
  if (plane.normal == Point{}) refuse(fmt::format("{}: {} has a zero normal", option, text));
  return plane;
}

}  // namespace verisq::command_line
