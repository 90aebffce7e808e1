/// Its options, what they leave open, and the poses that they stand for.
#include "host/command_line/way_option.hpp"

#include <fmt/core.h>

#include <cmath>
#include <verisq/pose_file.hpp>

#include "host/command_line/direction_option.hpp"
#include "host/command_line/finite_number.hpp"
#include "host/command_line/length_option.hpp"
#include "host/errors/refusal.hpp"

namespace verisq::command_line {
namespace {

double parse_turn(std::string_view option, const std::string& text) {
  const std::optional<double> degrees = finite_number(text);
  if (!degrees || std::abs(*degrees) > 360.0)
    refuse(fmt::format("{}: {} is not a number between -360 and 360", option, text));
  return *degrees;
}

}  // namespace

void declare_way(Options& options, WayArguments& arguments) {
  options.add("--poses", arguments.poses, "FILE", "The path: .csv with tx,ty,tz,qw,qx,qy,qz a line");
  options.add("--along", arguments.along, parse_direction, "x,y,z",
              "Instead of --poses: the direction of a straight way in");
  options.add("--length", arguments.length, parse_positive_length, "NUMBER", "Of the straight way, in model units");
  options.add("--turn", arguments.turn, parse_turn, "DEGREES",
              "By which the implant turns on the straight way, right-handed about its direction, through the middle of "
              "the implant's bounding box (default 0)");
}

void check_usage(const WayArguments& arguments) {
  if (arguments.poses.has_value() == arguments.along.has_value()) refuse("give either --poses or --along");
  if (arguments.along && !arguments.length) refuse("--along: give the --length of the way");
  if (arguments.poses && arguments.length) refuse("--length: only for --along, not for --poses");
  if (arguments.poses && arguments.turn) refuse("--turn: only for --along, not for --poses");
}

WayIn given_way(const WayArguments& arguments) {
  return {*arguments.along, *arguments.length, arguments.turn.value_or(0.0)};
}

std::vector<Pose> path_of(const WayArguments& arguments, const Model& implant) {
  return arguments.poses ? read_poses(*arguments.poses)
                         : verisq::path_of(given_way(arguments), turning_centre(implant));
}

}  // namespace verisq::command_line
