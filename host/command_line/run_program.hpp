/// What every program begins and ends with: the command line is parsed, errors become one line and an exit status.
#pragma once

#include <span>
#include <string>

#include "host/command_line/command.hpp"

namespace verisq::command_line {

/// What a program says of itself.
struct Program {
  std::string name;
  std::string description;
  std::string closing_words = {};  ///< at the end of its help
};

/// Parses, then runs the command that was asked for; returns the exit status. What is wrong is one line on the standard
/// error that begins with the program's name.
[[nodiscard]] int run_program(const Program& program, std::span<const Command> commands, int argc, char** argv);

/// A program that is one command, whose name and description are those of the program.
[[nodiscard]] int run_program(const Program& program, const Command& command, int argc, char** argv);

}  // namespace verisq::command_line
