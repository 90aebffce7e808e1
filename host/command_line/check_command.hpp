/// `verisq check`, which is also the program `verisq-check`: proves a finished map again from the model, the points or
/// triangles, and the certificates, without OpenCL.
#pragma once

#include <string>

#include "host/command_line/exit_status.hpp"
#include "host/command_line/point_stream.hpp"

namespace verisq::command_line {

/// As typed.
struct CheckArguments {
  InputArguments inputs;
  std::string map;
  std::string point_radius = "0";  ///< text, so that it is read to the nearest binary64
  bool json = false;
  bool no_progress = false;
};

/// Adds the options and their explanation to `command`, whose name the examples show; parsing fills `arguments`, which
/// must outlive it.
void declare_check_options(CLI::App& command, CheckArguments& arguments);

/// Adds the command to `program`; parsing fills `arguments`, which must outlive `program`.
const CLI::App& declare_check(CLI::App& program, CheckArguments& arguments);

/// `verified` only when every enclosure is proved. Throws Error(input) for what the user can correct, also for a map
/// that has not one row for each point or triangle.
ExitStatus run_check(const CheckArguments& arguments);

}  // namespace verisq::command_line
