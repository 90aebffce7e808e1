/// `verisq surface` of the program `verisq`: it starts `verisq-surface`, a program of its own because of the licence of
/// what is linked there.
#pragma once

#include <string>
#include <vector>

#include "host/command_line/exit_status.hpp"
#include "host/command_line/options.hpp"

namespace verisq::command_line {

inline constexpr const char* surface_description =
    "Closed oriented surface from points, a damaged mesh or a labelled volume; canals";

/// By which `verisq surface` starts `verisq-surface`, which then answers as that command.
inline constexpr const char* name_of_caller = "verisq";

struct SurfaceProgramArguments {
  std::vector<std::string> all;  ///< what follows the command
};

void declare_surface_program(Options& options, SurfaceProgramArguments& arguments);

/// Never returns: the process becomes the other program. Throws Error(input) where that does not lie in the folder of
/// the running program, Error(failure) where it does not start.
ExitStatus run_surface_program(const SurfaceProgramArguments& arguments);

}  // namespace verisq::command_line
