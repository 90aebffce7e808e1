/// Its options, what they leave open, and the poses that they stand for.
#include "host/command_line/insertion_inputs.hpp"

#include <fmt/format.h>

#include <cmath>
#include <verisq/pose_file.hpp>
#include <verisq/signed_distance.hpp>

#include "host/command_line/default_tolerance.hpp"
#include "host/command_line/direction_option.hpp"
#include "host/command_line/finite_number.hpp"
#include "host/command_line/length_option.hpp"
#include "host/command_line/overwriting.hpp"
#include "host/command_line/pose_option.hpp"
#include "host/command_line/posed_input.hpp"
#include "host/command_line/shared_options.hpp"
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

void declare_inputs(Options& options, InsertionInputs& inputs) {
  require_model(options, "--implant", inputs.implant);
  add_pose(options, inputs.pose);
  options.require("--mesh", inputs.mesh, "FILE",
                  "The bone, or its cavity, whose vertices are meant: .stl .obj .ply .off");
  options.add("--poses", inputs.poses, "FILE", "The path: .csv with tx,ty,tz,qw,qx,qy,qz a line");
  options.add("--along", inputs.along, parse_direction, "x,y,z",
              "Instead of --poses: the direction of a straight way in");
  options.add("--length", inputs.length, parse_positive_length, "NUMBER", "Of the straight way, in model units");
  options.add("--turn", inputs.turn, parse_turn, "DEGREES",
              "By which the implant turns on the straight way, right-handed about its direction, through the middle of "
              "the implant's bounding box (default 0)");
  options.add("--tol", inputs.tolerance, parse_positive_length, "NUMBER",
              fmt::format("Largest width of a verified enclosure, in model units, more than 0.\n"
                          "Default: {} times the radius of the implant's bounding sphere",
                          tolerance_along_ways.text));
}

void check_usage(const InsertionInputs& inputs) {
  if (inputs.poses.has_value() == inputs.along.has_value()) refuse("give either --poses or --along");
  if (inputs.along && !inputs.length) refuse("--along: give the --length of the way");
  if (inputs.poses && inputs.length) refuse("--length: only for --along, not for --poses");
  if (inputs.poses && inputs.turn) refuse("--turn: only for --along, not for --poses");
}

void refuse_to_overwrite(const std::string& output, const InsertionInputs& inputs) {
  command_line::refuse_to_overwrite("-o", output, {inputs.implant, inputs.mesh, inputs.poses.value_or("")});
}

WayIn given_way(const InsertionInputs& inputs) {
  return {*inputs.along, *inputs.length, inputs.turn.value_or(0.0)};
}

std::vector<Pose> path_of(const InsertionInputs& inputs, const Model& implant) {
  return inputs.poses ? read_poses(*inputs.poses) : verisq::path_of(given_way(inputs), turning_centre(implant));
}

double tolerance_of(const InsertionInputs& inputs, const Model& implant) {
  return inputs.tolerance ? *inputs.tolerance
                          : default_tolerance(tolerance_along_ways, bounding_radius(implant), "the implant");
}

}  // namespace verisq::command_line
