/// Reads the options and the model of `verisq mesh`, meshes it, looks at what came out, writes it, reports.
#include "host/command_line/mesh_command.hpp"

#include <fmt/core.h>

#include <filesystem>
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
#include "host/command_line/proven_deviation.hpp"
#include "host/command_line/shared_options.hpp"
#include "host/command_line/stopwatch.hpp"
#include "host/errors/refusal.hpp"
#include "host/files/words.hpp"

namespace verisq::command_line {
namespace {

constexpr const char* closing_words =
    "The mesh is closed, manifold and oriented outward, which is checked of every mesh; of a union it is the boundary\n"
    "of the whole, with no triangles inside. Vertices lie on the model's surface, many of them on edges and corners.\n"
    "STL rounds coordinates to binary32; .ply and .off keep them.\n"
    "The deviation printed is proven of the mesh as it is written: no point of either surface is farther from the "
    "other\n"
    "one. Where it is more than asked for, the model is meshed anew, finer, up to three times. Ctrl-C writes no file.\n"
    "\n"
    "Exit status: 0 written, the deviation is proven to be at most --deviation; 3 written, it is not; 2 bad usage or\n"
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

/// The coordinates that a reader of the file will find.
void round_as_written(Mesh& mesh, const std::string& output) {
  if (lower_case(std::filesystem::path(output).extension().string()) != ".stl") return;
  for (Point& vertex : mesh.vertices) {
    for (double& x : vertex) x = static_cast<double>(static_cast<float>(x));
  }
}

struct ProvenMesh {
  ModelMesh found;
  std::optional<Enclosure> deviation = {};
};

ModelMesh meshed(const Model& model, double deviation, const MeshArguments& arguments) {
  ProgressBar bar(!arguments.no_progress, "triangles");
  ModelMeshOptions options{.deviation = deviation};
  options.interrupted = interrupted;
  options.progress = [&](std::string_view state, double fraction) { bar.update_state(state, fraction); };
  return model_mesh(model, options);
}

/// Finer and finer until it is proven to be as near as asked for, at most so many times.
ProvenMesh proven_mesh(const Model& model, const MeshArguments& arguments) {
  constexpr int most_tries = 3;
  constexpr double margin = 0.8;
  const double wanted = *arguments.deviation;
  double aim = wanted;
  for (int tries = 1;; ++tries) {
    ProvenMesh result{.found = meshed(model, aim, arguments)};
    if (result.found.interrupted) return result;
    round_as_written(result.found.mesh, arguments.output);
    if (arguments.no_proof) return result;
    const Deviation proof =
        proven_deviation(model, result.found.mesh,
                         {.device = arguments.device, .no_progress = arguments.no_progress, .statistics = false});
    result.found.interrupted = proof.interrupted;
    result.deviation = proof.hausdorff.value_or(Enclosure{0.0, infinity});
    const double proven = result.deviation->hi;
    if (proven <= wanted || !(proven < infinity) || tries == most_tries || proof.interrupted) return result;
    aim *= margin * wanted / proven;
  }
}

}  // namespace

void declare_mesh(Options& options, MeshArguments& arguments) {
  options.explain(closing_words);
  require_model(options, "--model", arguments.model);
  options.add("--deviation", arguments.deviation, parse_positive_length, "NUMBER",
              "How far mesh and surface may be from each other, in model units (required)");
  options.require("-o,--output", arguments.output, "FILE", "The mesh, by extension: .stl .ply .off .obj");
  options.add_flag("--no-proof", arguments.no_proof,
                   "Estimate the deviation at samples of the mesh instead: bent models take long to prove");
  add_device(options, arguments.device);
  add_json_of_enclosures(options, arguments.json);
  add_no_progress(options, arguments.no_progress);
}

ExitStatus run_mesh(const MeshArguments& arguments) {
  if (!arguments.deviation) refuse("--deviation is required");
  check_mesh_name(arguments.output);
  refuse_to_overwrite("-o", arguments.output, {arguments.model});
  const Model model = read_model(arguments.model);
  watch_for_interruption();
  const Stopwatch stopwatch;

  const ProvenMesh proven = proven_mesh(model, arguments);
  const ModelMesh& found = proven.found;
  if (found.interrupted) {
    tell(fmt::format("interrupted; {} is not written", arguments.output));
    return ExitStatus::interrupted;
  }
  const MeshReport report{.deviation = *arguments.deviation,
                          .found = found,
                          .proven = proven.deviation,
                          .topology = mesh_topology(found.mesh),
                          .volume = signed_volume(found.mesh),
                          .output = arguments.output,
                          .units = model.units,
                          .seconds = stopwatch.seconds()};
  const std::string what = defect(report.topology, report.volume);
  if (!what.empty()) throw Error(ErrorKind::failure, fmt::format("{}: the mesh is {}", arguments.output, what));
  write_mesh(arguments.output, found.mesh);
  fmt::print("{}", arguments.json ? json(report) : readable(report));
  const double reached = proven.deviation ? proven.deviation->hi : found.estimated_deviation;
  return reached <= *arguments.deviation ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace verisq::command_line
