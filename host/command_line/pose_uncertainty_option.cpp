/// Lengths and an angle as bounds of a pose.
#include "host/command_line/pose_uncertainty_option.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <numbers>
#include <vector>
#include <verisq/posed_model.hpp>

#include "host/command_line/length_option.hpp"
#include "host/command_line/number_list.hpp"
#include "host/errors/refusal.hpp"

namespace verisq::command_line {
namespace {

std::array<double, 3> parse_translation_error(std::string_view option, const std::string& text) {
  if (text.find(',') == std::string::npos) {
    const double each = parse_length(option, text);
    return {each, each, each};
  }
  const std::vector<double> numbers = parse_numbers(option, text, "x,y,z");
  if (std::ranges::any_of(numbers, [](double x) { return x < 0.0; })) {
    refuse(fmt::format("{}: {} has a negative length", option, text));
  }
  return {numbers[0], numbers[1], numbers[2]};
}

double parse_rotation_error(std::string_view option, const std::string& text) {
  const double degrees = parse_length(option, text);
  if (degrees > 180.0) refuse(fmt::format("{}: {} is more than 180 degrees", option, text));
  return radians_up(degrees);
}

Point parse_centre(std::string_view option, const std::string& text) {
  const std::vector<double> numbers = parse_numbers(option, text, "x,y,z");
  return {numbers[0], numbers[1], numbers[2]};
}

}  // namespace

void add_pose_uncertainty(Options& options, PoseUncertaintyArguments& arguments, const std::string& whose) {
  options.add(
      "--translation-error", arguments.translation, parse_translation_error, "T | X,Y,Z",
      fmt::format("{} place is known to within this along each axis, in model units: each row then contains the "
                  "distances\nat all places that this and --rotation-error allow (default 0)",
                  whose));
  options.add("--rotation-error", arguments.rotation, parse_rotation_error, "DEGREES",
              "It may also be turned, about any axis, by at most so much (default 0)");
  options.add("--rotation-centre", arguments.centre, parse_centre, "X,Y,Z",
              "What such a turn leaves in place, in the coordinates of the model's file (default: its origin)");
}

std::optional<PoseUncertainty> pose_uncertainty(const PoseUncertaintyArguments& arguments) {
  if (arguments.centre && !arguments.rotation) refuse("--rotation-centre: give the --rotation-error about it");
  if (!arguments.translation && !arguments.rotation) return std::nullopt;
  return PoseUncertainty{.translation = arguments.translation.value_or(std::array<double, 3>{}),
                         .rotation = arguments.rotation.value_or(0.0),
                         .centre = arguments.centre.value_or(Point{})};
}

std::optional<PoseUncertainty> pose_uncertainty(const PoseUncertaintyArguments& arguments,
                                                const std::optional<Pose>& pose) {
  std::optional<PoseUncertainty> bounds = pose_uncertainty(arguments);
  if (bounds && pose) bounds->centre = posed(bounds->centre, *pose);
  return bounds;
}

std::string described(const PoseUncertainty& bounds, const std::string& units) {
  const auto& [x, y, z] = bounds.translation;
  const double degrees = bounds.rotation * 180 / std::numbers::pi;  // as typed: what is proven allows a little more
  const auto& c = bounds.centre;
  return fmt::format("its place known to {}, {}, {}{} along the axes and {:.9g} degrees about ({}, {}, {})", x, y, z,
                     units.empty() ? "" : " " + units, degrees, c[0], c[1], c[2]);
}

}  // namespace verisq::command_line
