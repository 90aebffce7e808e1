/// Seven numbers as a pose.
#include "host/command_line/pose_option.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <vector>

#include "host/command_line/number_list.hpp"
#include "host/errors/refusal.hpp"

namespace verisq::command_line {

Pose parse_pose(std::string_view option, const std::string& text) {
  const std::vector<double> numbers = parse_numbers(option, text, "tx,ty,tz,qw,qx,qy,qz");
  const Pose pose{{numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5], numbers[6]}};
  if (std::ranges::all_of(pose.quaternion, [](double q) { return q == 0.0; })) {
    refuse(fmt::format("{}: {} has a zero quaternion", option, text));
  }
  return pose;
}

std::string option_text(const Pose& pose) {
  const auto& [t, q] = pose;
  return fmt::format("{},{},{},{},{},{},{}", t[0], t[1], t[2], q[0], q[1], q[2], q[3]);
}

}  // namespace verisq::command_line
