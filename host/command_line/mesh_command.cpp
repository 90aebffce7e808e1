/// Reads the options and the model of `verisq mesh`, meshes it, looks at what came out, writes it, reports.
#include "host/command_line/mesh_command.hpp"

#include <fmt/core.h>

#include <verisq/error.hpp>
#include <verisq/mesh_file.hpp>
#include <verisq/mesh_topology.hpp>
#include <verisq/model_file.hpp>
#include <verisq/model_mesh.hpp>

#include "host/command_line/interruption.hpp"
#include "host/command_line/length_option.hpp"
#include "host/command_line/mesh_summary.hpp"
#include "host/command_line/messages.hpp"
#include "host/command_line/overwriting.hpp"
#include "host/command_line/progress_bar.hpp"
#include "host/command_line/refusal.hpp"
#include "host/command_line/shared_options.hpp"
#include "host/command_line/stopwatch.hpp"

namespace verisq::command_line {
namespace {

constexpr const char* closing_words =
    "The mesh is closed, manifold and oriented outward, which is checked of every mesh; of a union it is the boundary\n"
    "of the whole, with no triangles inside. Vertices lie on the model's surface, many of them on edges and corners.\n"
    "STL rounds coordinates to binary32; .ply and .off keep them.\n"
    "The deviation printed is estimated at samples of the mesh: no proof. Ctrl-C writes no file.\n"
    "\n"
    "Exit status: 0 written, the estimated deviation is at most --deviation; 3 written, it is more; 2 bad usage or\n"
    "input; 130 interrupted by Ctrl-C.\n"
    "\n"
    "Examples:\n"
    "  verisq mesh --model stem.json --deviation 0.05 -o stem.stl\n"
    "  verisq mesh --model stem.json --deviation 0.01 -o stem.ply --json";

/// What the mesh is not, or nothing.
std::string defect(const MeshTopology& topology, double volume) {
  if (!topology.closed()) return "not closed";
  if (!topology.manifold()) return "not manifold";
  if (!topology.oriented()) return "not consistently oriented";
  return volume > 0.0 ? "" : "not oriented outward";
}

}  // namespace

void declare_mesh(Options& options, MeshArguments& arguments) {
  options.explain(closing_words);
  require_model(options, "--model", arguments.model);
  options.add("--deviation", arguments.deviation, parse_positive_length, "NUMBER",
              "How far mesh and surface may be from each other, in model units (required)");
  options.require("-o,--output", arguments.output, "FILE", "The mesh, by extension: .stl .ply .off .obj");
  add_json(options, arguments.json);
  add_no_progress(options, arguments.no_progress);
}

ExitStatus run_mesh(const MeshArguments& arguments) {
  if (!arguments.deviation) refuse("--deviation is required");
  check_mesh_name(arguments.output);
  refuse_to_overwrite("-o", arguments.output, {arguments.model});
  const Model model = read_model(arguments.model);
  watch_for_interruption();
  const Stopwatch stopwatch;

  std::optional<ProgressBar> bar(std::in_place, !arguments.no_progress, "triangles");
  ModelMeshOptions options{.deviation = *arguments.deviation};
  options.interrupted = interrupted;
  options.progress = [&](std::string_view state, double fraction) { bar->update_state(state, fraction); };
  const ModelMesh found = model_mesh(model, options);
  bar.reset();
  if (found.interrupted) {
    tell(fmt::format("interrupted; {} is not written", arguments.output));
    return ExitStatus::interrupted;
  }
  const MeshReport report{.deviation = *arguments.deviation,
                          .found = found,
                          .topology = mesh_topology(found.mesh),
                          .volume = signed_volume(found.mesh),
                          .output = arguments.output,
                          .units = model.units,
                          .seconds = stopwatch.seconds()};
  const std::string what = defect(report.topology, report.volume);
  if (!what.empty()) throw Error(ErrorKind::failure, fmt::format("{}: the mesh is {}", arguments.output, what));
  write_mesh(arguments.output, found.mesh);
  fmt::print("{}", arguments.json ? json(report) : readable(report));
  return found.estimated_deviation <= *arguments.deviation ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace verisq::command_line
