/// `verisq distance`: encloses the distance of two models and their closest points.
#pragma once

#include <optional>
#include <string>

#include "host/command_line/exit_status.hpp"

namespace CLI {
class App;
}

namespace verisq::command_line {

/// As typed.
struct DistanceArguments {
  std::string model_a;
  std::string model_b;
  std::optional<std::string> pose;
  std::optional<std::string> tolerance;
  bool json = false;
  bool certificate = false;
};

/// Adds the command to `program`; parsing fills `arguments`, which must outlive `program`.
const CLI::App& declare_distance(CLI::App& program, DistanceArguments& arguments);

/// `verified` when the enclosure is at most the tolerance wide. Throws Error(input) for what the user can correct.
ExitStatus run_distance(const DistanceArguments& arguments);

}  // namespace verisq::command_line
