/// The program `verisq-surface`: `verisq surface` and nothing else, so that only here parts under the GPL are linked.
#include <array>
#include <string_view>

#include "host/command_line/run_program.hpp"
#include "host/command_line/surface_command.hpp"
#include "host/command_line/surface_program.hpp"

int main(int argc, char** argv) {
  using namespace verisq::command_line;
  const std::array commands{command("surface", surface_description, declare_surface, run_surface)};
  if (argc > 0 && std::string_view(argv[0]) == name_of_caller) {
    return run_program({.name = name_of_caller, .description = ""}, commands, argc, argv);
  }
  const Program program{.name = "verisq-surface", .description = surface_description};
  return run_program(program, commands.front(), argc, argv);
}
