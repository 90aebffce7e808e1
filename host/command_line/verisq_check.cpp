/// The program `verisq-check`: `verisq check` and nothing else, so that whoever trusts a checked map has to trust no
/// more than is linked here.
#include <CLI/CLI.hpp>
#include <verisq/version.hpp>

#include "host/command_line/check_command.hpp"
#include "host/command_line/run_program.hpp"

int main(int argc, char** argv) {
  using namespace verisq::command_line;
  CLI::App program("Prove a finished map again from its certificates, by MPFR alone", "verisq-check");
  program.set_version_flag("--version", "verisq-check " VERISQ_VERSION, "Print the version and exit");
  CheckArguments arguments;
  declare_check_options(program, arguments);
  return run_program(program, argc, argv, [&] { return run_check(arguments); });
}
