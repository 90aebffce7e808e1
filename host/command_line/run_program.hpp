/// What every program begins and ends with: the command line is parsed, errors become one line and an exit status.
#pragma once

#include <functional>

#include "host/command_line/exit_status.hpp"

namespace CLI {
class App;
}

namespace verisq::command_line {

/// Parses, then calls `command`; returns the exit status. What is wrong is one line on the standard error that begins
/// with the program's name.
[[nodiscard]] int run_program(CLI::App& program, int argc, char** argv, const std::function<ExitStatus()>& command);

}  // namespace verisq::command_line
