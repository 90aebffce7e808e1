/// `verisq mesh`: a model's surface as a closed triangle mesh.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <verisq/enclosure.hpp>
#include <verisq/error.hpp>
#include <verisq/files.hpp>
#include <verisq/mesh_topology.hpp>

#include "host/command_line/deviation_command.hpp"
#include "host/command_line/inputs.hpp"
#include "host/command_line/options.hpp"
#include "host/command_line/run.hpp"
#include "host/command_line/summaries.hpp"
#include "host/errors/refusal.hpp"
#include "host/files/words.hpp"
#include "host/prepare/mesh_geometry.hpp"

namespace verisq::command_line {
namespace {

// The summary of a model's mesh on the standard output: for people, or as one JSON object.

struct MeshReport {
  double deviation;  ///< the requested deviation
  const ModelMesh& found;
  std::optional<Enclosure> proven;  ///< two-sided Hausdorff distance of the mesh as it is written from the surface
  MeshTopology topology;
  double volume;
  std::string output;
  std::string units;  ///< of the model; empty when not given
  double seconds;
};

/// As typed; `run_mesh` checks what depends on the file.
struct MeshArguments {
  std::string model;
  std::optional<double> deviation;
  std::string output;
  std::string device = "auto";
  bool no_proof = false;
  std::optional<double> time_limit;  ///< in seconds
  bool json = false;
  bool no_progress = false;
};

/// A cube of lengths may have no binary64 number; the mesh has a volume above 0.
bool is_told(double volume) {
  return volume > 0.0 && std::isfinite(volume);
}

std::string readable(const MeshReport& report) {
  const std::string units = units_behind(report.units);
  const std::string cubic_units = units_behind(report.units, 3);
  const MeshTopology& topology = report.topology;
  std::string text;
  const std::string deviation = report.proven
                                    ? fmt::format("{}{}, proven both ways", outward_digits(*report.proven), units)
                                    : fmt::format("{:.3g}{}, estimated at {} points of the mesh, not proven",
                                                  report.found.estimated_deviation, units, report.found.samples);
  text += fmt::format("deviation          {}; wanted {:g}{}\n", deviation, report.deviation, units);
  text += fmt::format("triangles          {}\n", topology.triangles);
  text += fmt::format("vertices           {}\n", topology.vertices);
  text += fmt::format("surface            closed, manifold, outward; {} of genus {}\n",
                      topology.components == 1 ? "one component" : fmt::format("{} components", topology.components),
                      topology.genus().value_or(0));
  text += is_told(report.volume) ? fmt::format("volume             {:.6g}{}\n", report.volume, cubic_units)
                                 : "volume             not told: no binary64 number is that large or small\n";
  text += fmt::format("time               {:.3g} s\n", report.seconds);
  text += fmt::format("mesh               {}\n", quotation(report.output));
  return text;
}

/// One line.
std::string json(const MeshReport& report) {
  const MeshTopology& topology = report.topology;
  const JsonObject object{
      {"proven_deviation", report.proven},
      {"deviation", report.deviation},
      {"units", report.units},
      {"triangles", topology.triangles},
      {"vertices", topology.vertices},
      {"components", topology.components},
      {"genus", topology.genus()},
      {"closed", topology.closed()},
      {"manifold", topology.manifold()},
      {"oriented", topology.oriented()},
      {"volume", is_told(report.volume) ? JsonValue(report.volume) : JsonValue()},
      {"seconds", report.seconds},
      {"output", report.output},
  };
  return object.text() + "\n";
}

constexpr const char* closing_words =
    R"(The mesh is closed, manifold and oriented outward, which is checked of every mesh; of a union it is the boundary
of the whole, with no triangles inside. Vertices lie on the model's surface, many of them on edges and corners.
STL rounds coordinates to binary32; .ply and .off keep them.
The deviation printed is proven of the mesh as it is written: no point of either surface is farther from the other
one. Where it is more than asked for, the model is meshed anew, finer, up to three times. Ctrl-C and --time-limit
write no file.

Exit status: 0 written, the deviation is proven to be at most --deviation; 3 written, it is not, or
ended by --time-limit; 2 bad usage or input; 130 interrupted by Ctrl-C.

Examples:
  verisq mesh --model stem.json --deviation 0.05 -o stem.stl
  verisq mesh --model stem.json --deviation 0.01 -o stem.ply --json)";

/// The property that the mesh lacks, or an empty text.
std::string defect(const MeshTopology& topology, int volume_sign) {
  if (!topology.closed()) return "not closed";
  if (!topology.manifold()) return "not manifold";
  if (!topology.oriented()) return "not consistently oriented";
  return volume_sign > 0 ? "" : "not oriented outward";
}

/// Takes the coordinates that a reader of the file will find. Refuses to move vertices farther than the surface may be
/// off: finer triangles would make it worse.
void round_as_written(ModelMesh& found, const MeshArguments& arguments) {
  if (lower_case(std::filesystem::path(arguments.output).extension().string()) != ".stl") return;
  double farthest = 0.0;
  for (Point& vertex : found.mesh.vertices) {
    Point way{};
    for (std::size_t i = 0; i < 3; ++i) {
      const bool overflows = std::fabs(vertex[i]) > static_cast<double>(std::numeric_limits<float>::max());
      const double rounded = overflows ? infinity : static_cast<double>(static_cast<float>(vertex[i]));
      way[i] = rounded - vertex[i];
      vertex[i] = rounded;
    }
    farthest = std::max(farthest, std::hypot(way[0], way[1], way[2]));
  }
  if (farthest > *arguments.deviation) {
    refuse(
        fmt::format("{}: STL's binary32 numbers would move vertices by up to {:.3g}, more than --deviation {}: write a "
                    ".ply, or bring the model near the origin",
                    arguments.output, farthest, *arguments.deviation));
  }
  found.estimated_deviation += farthest;
}

struct ProvenMesh {
  ModelMesh found;
  std::optional<Enclosure> deviation = {};
};

ModelMesh meshed(const Model& model, double deviation, const MeshArguments& arguments, const Deadline& limit) {
  ProgressBar bar(!arguments.no_progress, "triangles");
  ModelMeshOptions options{.deviation = deviation};
  options.interrupted = limit.stop();
  options.progress = [&](std::string_view state, double fraction) { bar.update_state(state, fraction); };
  return model_mesh(model, options);
}

/// Makes the mesh finer until it is proven to be as near as requested, at most so many times.
ProvenMesh proven_mesh(const Model& model, const MeshArguments& arguments, const Deadline& limit) {
  constexpr int most_tries = 3;
  constexpr double margin = 0.8;
  const double wanted = *arguments.deviation;
  double aim = wanted;
  for (int tries = 1;; ++tries) {
    ProvenMesh result{.found = meshed(model, aim, arguments, limit)};
    if (result.found.interrupted) return result;
    round_as_written(result.found, arguments);
    if (arguments.no_proof) return result;
    const Deviation proof = proven_deviation(
        model, result.found.mesh,
        {.device = arguments.device, .no_progress = arguments.no_progress, .statistics = false, .ended = limit.stop()});
    result.found.interrupted = proof.interrupted;
    result.deviation = proof.hausdorff.value_or(Enclosure{0.0, infinity});
    const double proven = result.deviation->hi;
    if (proven <= wanted || !(proven < infinity) || tries == most_tries || proof.interrupted) return result;
    aim *= margin * wanted / proven;
  }
}

void declare_mesh(Options& options, MeshArguments& arguments) {
  options.explain(closing_words);
  require_model(options, "--model", arguments.model);
  options.add("--deviation", arguments.deviation, parse_positive_length, "NUMBER",
              "How far mesh and surface may be from each other, in model units (required)");
  options.require("-o,--output", arguments.output, "FILE", "The mesh, by extension: .stl .ply .off .obj");
  options.add_flag("--no-proof", arguments.no_proof,
                   "Estimate the deviation at samples of the mesh instead: bent models take long to prove");
  add_device(options, arguments.device);
  add_time_limit(options, arguments.time_limit, "no file is written then");
  add_json_of_enclosures(options, arguments.json);
  add_no_progress(options, arguments.no_progress);
}

/// Throws Error(input) for whatever the user can correct.
ExitStatus run_mesh(const MeshArguments& arguments) {
  if (!arguments.deviation) refuse("--deviation is required");
  check_mesh_name(arguments.output);
  refuse_to_overwrite("-o", arguments.output, {arguments.model});
  const Model model = read_model(arguments.model);
  watch_for_interruption();
  Deadline limit(arguments.time_limit, interrupted);
  limit.start();
  const Stopwatch stopwatch;

  const ProvenMesh proven = proven_mesh(model, arguments, limit);
  const ModelMesh& found = proven.found;
  if (found.interrupted) {
    tell(fmt::format("{}; {} is not written", reason_of_end(), arguments.output));
    return status_of_end();
  }
  const MeshReport report{.deviation = *arguments.deviation,
                          .found = found,
                          .proven = proven.deviation,
                          .topology = mesh_topology(found.mesh),
                          .volume = signed_volume(found.mesh),
                          .output = arguments.output,
                          .units = model.units,
                          .seconds = stopwatch.seconds()};
  const std::string what = defect(report.topology, volume_sign(found.mesh));
  if (!what.empty()) throw Error(ErrorKind::failure, fmt::format("{}: the mesh is {}", arguments.output, what));
  write_mesh(arguments.output, found.mesh);
  fmt::print("{}", arguments.json ? json(report) : readable(report));
  const double reached = proven.deviation ? proven.deviation->hi : found.estimated_deviation;
  return reached <= *arguments.deviation ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace

Command mesh_command() {
  return command("mesh", "Write a model's surface as a closed mesh, to a given deviation", declare_mesh, run_mesh);
}

}  // namespace verisq::command_line
