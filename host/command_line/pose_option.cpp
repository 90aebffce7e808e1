/// Splits at commas.
#include "host/command_line/pose_option.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <vector>
#include <verisq/error.hpp>

#include "host/command_line/finite_number.hpp"

namespace verisq::command_line {

Pose parse_pose(std::string_view option, const std::string& text) {
  const auto refuse = [option](const std::string& why) {
    throw Error(ErrorKind::input, fmt::format("{}: {}", option, why));
  };
  std::vector<double> numbers;
  std::string_view rest = text;
  for (bool more = true; more;) {
    const std::size_t comma = rest.find(',');
    const auto number = finite_number(rest.substr(0, comma));
    if (!number) refuse(fmt::format("'{}' is not a finite number", rest.substr(0, comma)));
    numbers.push_back(*number);
    more = comma != std::string_view::npos;
    if (more) rest.remove_prefix(comma + 1);
  }
  if (numbers.size() != 7) {
    refuse(fmt::format("{} numbers where 7 are needed: tx,ty,tz,qw,qx,qy,qz", numbers.size()));
  }
  const Pose pose{{numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5], numbers[6]}};
  if (std::ranges::all_of(pose.quaternion, [](double q) { return q == 0.0; })) {
    refuse(fmt::format("{} has a zero quaternion", text));
  }
  return pose;
}

}  // namespace verisq::command_line
