/// `verisq distance`: encloses the distance of two models and their closest points, or the distances for many poses.
#pragma once

#include <optional>
#include <string>

#include "host/command_line/exit_status.hpp"

namespace CLI {
class App;
}

namespace verisq::command_line {

/// As typed; `run_distance` checks what depends on several options.
struct DistanceArguments {
  std::string model_a;
  std::string model_b;
  std::optional<std::string> pose;
  std::optional<std::string> poses;       ///< a file, instead of one pose
  std::optional<std::string> output;      ///< of the distances for `poses`
  std::optional<std::string> device;      ///< for `poses`; "auto" when not given
  std::optional<std::string> tolerance;   ///< text, so that it is read to the nearest binary64
  std::optional<std::string> time_limit;  ///< text, in seconds
  bool json = false;
  bool certificate = false;
  bool no_progress = false;
};

/// Adds the command to `program`; parsing fills `arguments`, which must outlive `program`.
const CLI::App& declare_distance(CLI::App& program, DistanceArguments& arguments);

/// `verified` when every enclosure is at most the tolerance wide. Throws Error(input) for what the user can correct,
/// before the first distance is computed (a file of poses is a stream: its later lines are checked as they come).
ExitStatus run_distance(const DistanceArguments& arguments);

}  // namespace verisq::command_line
