/// The program `verisq`: the table of all commands, one of which it runs.
#include <array>

#include "host/command_line/batch_command.hpp"
#include "host/command_line/check_command.hpp"
#include "host/command_line/deviation_command.hpp"
#include "host/command_line/devices_command.hpp"
#include "host/command_line/distance_command.hpp"
#include "host/command_line/features_command.hpp"
#include "host/command_line/fit_command.hpp"
#include "host/command_line/insert_command.hpp"
#include "host/command_line/map_command.hpp"
#include "host/command_line/merge_command.hpp"
#include "host/command_line/mesh_command.hpp"
#include "host/command_line/octree_command.hpp"
#include "host/command_line/path_command.hpp"
#include "host/command_line/recover_command.hpp"
#include "host/command_line/run_program.hpp"
#include "host/command_line/stance_command.hpp"
#include "host/command_line/surface_program.hpp"

namespace {

constexpr const char* closing_words =
    "Exit status: 0 every enclosure verified (check: proved), 1 the program failed, 2 bad usage or input, 3 finished,\n"
    "some enclosures wide (check: not proved), 130 interrupted by Ctrl-C, 143 by SIGTERM, 129 by SIGHUP. These three\n"
    "keep what is finished; a run that is killed leaves the finished rows of a .csv under OUT.*.partial.\n"
    "`verisq COMMAND --help` explains a command.";

}  // namespace

int main(int argc, char** argv) {
  using namespace verisq::command_line;
  const std::array commands{
      command("map", "Enclose the distance of each vertex, triangle or point to a model", declare_map, run_map),
      command("batch", "Run the cases of a cohort, a row of a manifest each, resumably", declare_batch,
              run_batch_command),
      command("check", "Prove a finished map again from its certificates, without OpenCL", declare_check, run_check),
      command("distance", "Enclose the distance of two models, and closest points", declare_distance, run_distance),
      command("deviation", "Enclose how far a mesh and a model's surface lie apart, both ways", declare_deviation,
              run_deviation),
      command("features", "Enclose what a surgeon measures of a femur: head, offset, CCD, version", declare_features,
              run_features),
      command("fit", "Find the best pose of an implant in a bone, and prove its clearance", declare_fit, run_fit),
      command("insert", "Enclose how deep an implant cuts into the bone on its way in", declare_insert, run_insert),
      command("merge", "Make one map of all its parts, after checking that they belong together", declare_merge,
              run_merge),
      command("mesh", "Write a model's surface as a closed mesh, to a given deviation", declare_mesh, run_mesh),
      command("octree", "Prove cubes inside and outside a model, and enclose its volume", declare_octree, run_octree),
      command("path", "Enclose the smallest distance of two models while one moves, and when they meet", declare_path,
              run_path),
      command("recover", "Make a model of a point cloud or a mesh, without proof", declare_recover, run_recover),
      command("stance", "Enclose wrench, sensitivities and accelerations of a stance model with uncertain parameters",
              declare_stance, run_stance),
      command("surface", surface_description, declare_surface_program, run_surface_program),
      command("devices", "List every OpenCL device and the outcome of its self-test", declare_devices, run_devices),
  };
  const Program program{.name = "verisq",
                        .description =
                            "verisq: guaranteed distances for whole meshes.\n"
                            "Every answer is an interval of binary64 numbers that contains the exact result.",
                        .closing_words = closing_words};
  return run_program(program, commands, argc, argv);
}
