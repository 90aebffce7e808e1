/// `verisq path`: encloses the smallest distance of two models while one of them moves, and when they first meet.
#pragma once

#include <optional>
#include <string>

#include "host/command_line/exit_status.hpp"
#include "host/command_line/options.hpp"

namespace verisq::command_line {

struct PathArguments {
  std::string model_a;
  std::string model_b;
  std::string poses;
  std::optional<double> tolerance;
  std::optional<double> time_tolerance;
  std::optional<double> clearance;
  std::string certificate_file;
  bool json = false;
  bool no_progress = false;
};

void declare_path(Options& options, PathArguments& arguments);

/// `verified` only when the way is proven to be free. Throws Error(input) for what the user can correct.
ExitStatus run_path(const PathArguments& arguments);

}  // namespace verisq::command_line
