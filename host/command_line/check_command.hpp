/// `verisq check`, which is also the program `verisq-check`: proves a finished map again from the model, the points or
/// triangles, and the certificates, without OpenCL.
#pragma once

#include <string>

#include "host/command_line/exit_status.hpp"
#include "host/command_line/options.hpp"
#include "host/command_line/point_stream.hpp"

namespace verisq::command_line {

/// As typed.
struct CheckArguments {
  InputArguments inputs;
  std::string map;
  double point_radius = 0.0;
  bool json = false;
  bool no_progress = false;
};

void declare_check(Options& options, CheckArguments& arguments);

/// `verified` only when every enclosure is proved. Throws Error(input) for what the user can correct, also for a map
/// that has not one row for each point or triangle.
ExitStatus run_check(const CheckArguments& arguments);

}  // namespace verisq::command_line
