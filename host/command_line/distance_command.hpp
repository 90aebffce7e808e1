/// `verisq distance`: encloses the distance of two models and their closest points, or the distances for many poses.
#pragma once

#include <optional>
#include <string>
#include <verisq/model.hpp>

#include "host/command_line/exit_status.hpp"
#include "host/command_line/options.hpp"
#include "host/command_line/part_option.hpp"
#include "host/command_line/pose_uncertainty_option.hpp"

namespace verisq::command_line {

/// As typed; `run_distance` checks what depends on several options.
struct DistanceArguments {
  std::string model_a;
  std::string model_b;
  std::optional<Pose> pose;
  std::optional<std::string> poses;   ///< a file, instead of one pose
  std::optional<std::string> output;  ///< of the distances for `poses`
  std::optional<PartOption> part;     ///< of those for `poses`
  std::optional<std::string> device;  ///< for `poses`; "auto" when not given
  std::optional<double> tolerance;
  std::optional<double> time_limit;           ///< in seconds
  PoseUncertaintyArguments pose_uncertainty;  ///< for `poses`
  bool closest_points = false;                ///< for `poses`
  bool json = false;
  bool certificate = false;
  std::optional<std::string> certificate_file;
  bool no_progress = false;
};

void declare_distance(Options& options, DistanceArguments& arguments);

/// `verified` when every enclosure is at most the tolerance wide. Throws Error(input) for what the user can correct,
/// before the first distance is computed (a file of poses is a stream: its later lines are checked as they come).
ExitStatus run_distance(const DistanceArguments& arguments);

}  // namespace verisq::command_line
