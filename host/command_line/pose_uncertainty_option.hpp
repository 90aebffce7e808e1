/// The options that say how well the place of a model is known.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <verisq/model.hpp>
#include <verisq/pose_uncertainty.hpp>

#include "host/command_line/options.hpp"

namespace verisq::command_line {

/// As typed.
struct PoseUncertaintyArguments {
  std::optional<std::array<double, 3>> translation = {};
  std::optional<double> rotation = {};  ///< in radians, rounded up
  std::optional<Point> centre = {};     ///< in the model's own coordinates
};

/// Adds --translation-error, --rotation-error and --rotation-centre of `whose` place.
void add_pose_uncertainty(Options& options, PoseUncertaintyArguments& arguments, const std::string& whose);

/// Nothing where neither error is given. The centre is in the model's own coordinates. Throws Error(input) for a centre
/// that nothing turns about.
[[nodiscard]] std::optional<PoseUncertainty> pose_uncertainty(const PoseUncertaintyArguments& arguments);

/// Likewise with the centre moved by the pose, to nearest.
[[nodiscard]] std::optional<PoseUncertainty> pose_uncertainty(const PoseUncertaintyArguments& arguments,
                                                              const std::optional<Pose>& pose);

/// "its place known to 0.5, 0.5, 0.5 mm along the axes and 0.5 degrees about (0, 0, 40)".
[[nodiscard]] std::string described(const PoseUncertainty& bounds, const std::string& units);

}  // namespace verisq::command_line
