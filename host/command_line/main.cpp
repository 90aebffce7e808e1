/// The program `verisq`: all commands, one of which it runs.
#include <CLI/CLI.hpp>
#include <verisq/error.hpp>
#include <verisq/version.hpp>

#include "host/command_line/check_command.hpp"
#include "host/command_line/devices_command.hpp"
#include "host/command_line/distance_command.hpp"
#include "host/command_line/fit_command.hpp"
#include "host/command_line/insert_command.hpp"
#include "host/command_line/map_command.hpp"
#include "host/command_line/octree_command.hpp"
#include "host/command_line/run_program.hpp"
#include "host/command_line/stance_command.hpp"
#include "host/command_line/surface_command.hpp"

namespace verisq::command_line {
namespace {

constexpr const char* closing_words =
    "Exit status: 0 every enclosure verified (check: proved), 1 the program failed, 2 bad usage or input, 3 finished,\n"
    "some enclosures wide (check: not proved), 130 interrupted by Ctrl-C, 143 by SIGTERM, 129 by SIGHUP. These three\n"
    "keep what is finished; a run that is killed leaves the finished rows of a .csv under OUT.*.partial.\n"
    "`verisq COMMAND --help` explains a command.";

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
  return run_program(program, argc, argv, [&] {
    if (program.get_subcommands().empty()) throw Error(ErrorKind::input, "give a command (see verisq --help)");
    return map.parsed()        ? run_map(map_arguments)
           : check.parsed()    ? run_check(check_arguments)
           : distance.parsed() ? run_distance(distance_arguments)
           : fit.parsed()      ? run_fit(fit_arguments)
           : insert.parsed()   ? run_insert(insert_arguments)
           : octree.parsed()   ? run_octree(octree_arguments)
           : stance.parsed()   ? run_stance(stance_arguments)
           : surface.parsed()  ? run_surface(surface_arguments)
                               : run_devices(devices_arguments);
  });
}

}  // namespace
}  // namespace verisq::command_line

int main(int argc, char** argv) {
  return verisq::command_line::run(argc, argv);
}
