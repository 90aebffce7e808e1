/// The program `verisq`: reads the command line, runs one command, turns errors into one line and an exit status.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <verisq/error.hpp>

#include "host/command_line/check_command.hpp"
#include "host/command_line/devices_command.hpp"
#include "host/command_line/distance_command.hpp"
#include "host/command_line/exit_status.hpp"
#include "host/command_line/fit_command.hpp"
#include "host/command_line/insert_command.hpp"
#include "host/command_line/interruption.hpp"
#include "host/command_line/map_command.hpp"
#include "host/command_line/octree_command.hpp"
#include "host/command_line/stance_command.hpp"
#include "host/command_line/surface_command.hpp"

namespace verisq::command_line {
namespace {

constexpr const char* closing_words =
    "Exit status: 0 every enclosure verified (check: proved), 1 the program failed, 2 bad usage or input, 3 finished,\n"
    "some enclosures wide (check: not proved), 130 interrupted by Ctrl-C, 143 by SIGTERM, 129 by SIGHUP. These three\n"
    "keep what is finished; a run that is killed leaves the finished rows of a .csv under OUT.*.partial.\n"
    "`verisq COMMAND --help` explains a command.";

int report(const char* message, ExitStatus status) {
  fmt::print(stderr, "verisq: {}\n", message);
  return static_cast<int>(status);
}

int run(int argc, char** argv) {
  CLI::App program(
      "verisq: guaranteed distances for whole meshes.\n"
      "Every answer is an interval of binary64 numbers that contains the exact result.",
      "verisq");
  program.set_version_flag("--version", "verisq " VERISQ_VERSION, "Print the version and exit");
  program.footer(closing_words);
  MapArguments map_arguments;
  const CLI::App& map = declare_map(program, map_arguments);
  CheckArguments check_arguments;
  const CLI::App& check = declare_check(program, check_arguments);
  DistanceArguments distance_arguments;
  const CLI::App& distance = declare_distance(program, distance_arguments);
  FitArguments fit_arguments;
  const CLI::App& fit = declare_fit(program, fit_arguments);
  InsertArguments insert_arguments;
  const CLI::App& insert = declare_insert(program, insert_arguments);
  OctreeArguments octree_arguments;
  const CLI::App& octree = declare_octree(program, octree_arguments);
  StanceArguments stance_arguments;
  const CLI::App& stance = declare_stance(program, stance_arguments);
  SurfaceArguments surface_arguments;
  const CLI::App& surface = declare_surface(program, surface_arguments);
  DevicesArguments devices_arguments;
  declare_devices(program, devices_arguments);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // `--help` and `--version` arrive as errors of status 0, whose text CLI11 prints.
    if (error.get_exit_code() == 0) return program.exit(error);
    return report(fmt::format("{} (see verisq --help)", error.what()).c_str(), ExitStatus::bad_input);
  }
  if (program.get_subcommands().empty()) return report("give a command (see verisq --help)", ExitStatus::bad_input);
  const ExitStatus status = map.parsed()        ? run_map(map_arguments)
                            : check.parsed()    ? run_check(check_arguments)
                            : distance.parsed() ? run_distance(distance_arguments)
                            : fit.parsed()      ? run_fit(fit_arguments)
                            : insert.parsed()   ? run_insert(insert_arguments)
                            : octree.parsed()   ? run_octree(octree_arguments)
                            : stance.parsed()   ? run_stance(stance_arguments)
                            : surface.parsed()  ? run_surface(surface_arguments)
                                                : run_devices(devices_arguments);
  if (std::fflush(stdout) != 0) return report("cannot write to the standard output", ExitStatus::failed);
  return status == ExitStatus::interrupted ? status_of_interruption() : static_cast<int>(status);
}

}  // namespace
}  // namespace verisq::command_line

int main(int argc, char** argv) {
  using namespace verisq::command_line;
  try {
    return run(argc, argv);
  } catch (const verisq::Error& error) {
    return report(error.what(), error.kind() == verisq::ErrorKind::input ? ExitStatus::bad_input : ExitStatus::failed);
  } catch (const std::bad_alloc&) {
    return report("out of memory", ExitStatus::failed);
  } catch (const std::exception& error) {
    return report(error.what(), ExitStatus::failed);
  }
}
