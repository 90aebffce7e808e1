/// Reads the cloud or mesh, recovers, writes the model, reports.
#include "host/command_line/recover_command.hpp"

#include <fmt/core.h>

#include <cmath>
#include <string_view>
#include <vector>
#include <verisq/error.hpp>
#include <verisq/mesh_file.hpp>
#include <verisq/model_file.hpp>
#include <verisq/recovery.hpp>

#include "host/command_line/cloud_input.hpp"
#include "host/command_line/deviation_drawing.hpp"
#include "host/command_line/finite_number.hpp"
#include "host/command_line/interruption.hpp"
#include "host/command_line/length_option.hpp"
#include "host/command_line/messages.hpp"
#include "host/command_line/overwriting.hpp"
#include "host/command_line/progress_bar.hpp"
#include "host/command_line/proven_deviation.hpp"
#include "host/command_line/recover_summary.hpp"
#include "host/command_line/shared_options.hpp"
#include "host/command_line/stopwatch.hpp"
#include "host/command_line/whole_number.hpp"
#include "host/errors/refusal.hpp"
#include "host/files/output_file.hpp"

namespace verisq::command_line {
namespace {

constexpr std::size_t most_primitives = 64;
constexpr std::size_t most_for_deviation = 24;  // where --deviation alone says when to stop

constexpr const char* closing_words =
    "One primitive is the likeliest superquadric for the points: some may be missing, moved by noise, or outliers "
    "that\n"
    "belong to nothing. Several are a union, grown one by one; of a closed mesh they also fill its inside, and "
    "primitives\n"
    "that the union does as well without are left out at the end.\n"
    "\n"
    "Deviations on the way are estimated from samples, in floating point; that of the result from a mesh is proven, "
    "as\n"
    "`verisq deviation` does it. The same seed gives the same model.\n"
    "\n"
    "--inside and --outside begin with the same search. Then the union is fitted with the mesh's surface on one side "
    "of\n"
    "it, and grows or shrinks until that is proven, of all points of all triangles.\n"
    "\n"
    "Ctrl-C ends the search: the best model so far is written.\n"
    "\n"
    "Exit status: 0 done; 3 written, but --deviation is not reached, or --inside or --outside not proven; 2 bad usage\n"
    "or input; 130 interrupted by Ctrl-C.\n"
    "\n"
    "Examples:\n"
    "  verisq recover --points scan.csv -o part.json\n"
    "  verisq recover --mesh stem.stl --primitives 8 --taper --deviation 0.1 --units mm -o stem.json\n"
    "  verisq recover --mesh femur.stl --primitives 6 --report femur.html -o femur.json\n"
    "  verisq recover --mesh femur.stl --primitives 6 --outside -o hull.json";

std::optional<Containment> containment_of(const RecoverArguments& arguments) {
  if (arguments.inside) return Containment::within;
  if (arguments.outside) return Containment::around;
  return std::nullopt;
}

std::size_t most_of(const RecoverArguments& arguments) {
  return arguments.primitives.value_or(arguments.deviation ? most_for_deviation : 1);
}

RecoveryOptions options_of(const RecoverArguments& arguments) {
  if (arguments.points.empty() == arguments.mesh.empty()) refuse("give either --points or --mesh");
  if (arguments.outliers && !arguments.mesh.empty()) refuse("--outliers: is for --points; a mesh has none");
  if (arguments.inside && arguments.outside) refuse("give --inside or --outside, not both");
  if (const std::optional<Containment> containment = containment_of(arguments); containment && arguments.mesh.empty())
    refuse(fmt::format("--{}: needs a --mesh, whose solid it is about", option_of(*containment)));
  if (arguments.outside && arguments.bend && most_of(arguments) > 1)
    refuse(
        "--outside: that a union has no cavities is proven of unbent primitives alone; with --bend give --primitives "
        "1");
  RecoveryOptions options;
  options.primitives = most_of(arguments);
  options.deviation = arguments.deviation;
  options.taper = arguments.taper;
  options.bend = arguments.bend;
  options.most_outliers = arguments.outliers.value_or(options.primitives == 1 ? options.most_outliers : 0.0);
  options.seed = arguments.seed;
  options.interrupted = interrupted;
  return options;
}

/// Everything that the options alone tell, before any file is opened.
void check_usage(const RecoverArguments& arguments) {
  const std::vector<std::string> inputs{arguments.points, arguments.mesh};
  refuse_to_overwrite("-o", arguments.output, inputs);
  check_usage(arguments.report, inputs, {arguments.output});
  if (!arguments.report.any()) return;
  const char* const option = arguments.report.html.empty() ? "--png" : "--report";
  if (arguments.mesh.empty()) refuse(fmt::format("{}: give a --mesh to draw", option));
  if (arguments.no_proof) refuse(fmt::format("{}: shows the proven deviation; leave out --no-proof", option));
}

Mesh read_input(const RecoverArguments& arguments) {
  if (arguments.mesh.empty()) return read_cloud(arguments.points);
  Mesh mesh = read_mesh(arguments.mesh);
  if (mesh.triangles.empty()) refuse(fmt::format("{}: has no triangles; give it as --points", arguments.mesh));
  return mesh;
}

struct Found {
  Recovery recovery;
  std::optional<ContainedWords> contained;
};

Found searched(const Mesh& input, const RecoverArguments& arguments, const RecoveryOptions& options) {
  if (input.triangles.empty()) return {recover(input.vertices, options), {}};
  const std::optional<Containment> containment = containment_of(arguments);
  if (!containment) return {recover(input, options), {}};
  ContainedRecovery found =
      recover_contained(input, *containment, options, {.device = arguments.device, .interrupted = interrupted});
  return {std::move(found.recovery), ContainedWords{*containment, std::move(found.proof), found.proofs}};
}

Found search(const Mesh& input, const RecoverArguments& arguments, RecoveryOptions options) {
  ProgressBar bar(!arguments.no_progress, "primitives");
  const auto most = static_cast<double>(options.primitives);
  options.progress = [&bar, most](const RecoveryProgress& progress) {
    const std::string state =
        std::isfinite(progress.mean_deviation)
            ? fmt::format("primitive {}, mean deviation {:.4g} so far", progress.primitives, progress.mean_deviation)
            : fmt::format("primitive {}", progress.primitives);
    bar.update_state(state, static_cast<double>(progress.primitives - 1) / most);
  };
  try {
    return searched(input, arguments, options);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::input) throw;
    refuse(fmt::format("{}: {}", arguments.mesh.empty() ? arguments.points : arguments.mesh, error.what()));
  }
}

/// The mesh, coloured by how far it is from the model; false where that is not known of all vertices.
bool write_report(const RecoverArguments& arguments, const Model& model, const Mesh& mesh, const Deviation& proven) {
  if (!arguments.report.any()) return false;
  if (proven.map.interrupted) {
    tell("interrupted; report and picture are not written");
    return false;
  }
  const DeviationReport shown{.deviation = proven,
                              .options = {.percentiles = proven_percentiles},
                              .triangles = mesh.triangles.size(),
                              .units = model.units};
  write(arguments.report, {model, arguments.output, mesh, arguments.mesh}, shown);
  return true;
}

ExitStatus status_of(const RecoverReport& report) {
  if (report.recovery.interrupted || (report.proven && report.proven->interrupted)) return ExitStatus::interrupted;
  return report.reached() && report.is_contained() ? ExitStatus::verified : ExitStatus::unverified;
}

double parse_share(std::string_view option, const std::string& text) {
  const std::optional<double> share = finite_number(text);
  if (!share || *share < 0.0 || *share > 0.9) refuse(fmt::format("{}: {} is not from 0 to 0.9", option, text));
  return *share;
}

}  // namespace

void declare_recover(Options& options, RecoverArguments& arguments) {
  options.explain(closing_words);
  options.add("--points", arguments.points, "FILE",
              "Point cloud: text with x,y,z a line, .npy, or a mesh (.stl, .ply, .off, .obj), whose vertices count");
  options.add("--mesh", arguments.mesh, "FILE", "Instead of --points: a mesh, whose surface counts by its area");
  options.require("-o,--output", arguments.output, "FILE", "The model: .json");
  options.add(
      "--primitives", arguments.primitives, whole_number<std::size_t>(1, most_primitives), "NUMBER",
      fmt::format("At most so many, 1 to {} (default 1; with --deviation {})", most_primitives, most_for_deviation));
  options.add("--deviation", arguments.deviation, parse_positive_length, "LENGTH",
              "No more of them once 95 % of the surface deviate by at most this, by estimate, and of the model's");
  options.add_flag("--taper", arguments.taper, "Primitives may be tapered, their ends' sections as 1 to 4 at most");
  options.add_flag("--bend", arguments.bend, "Primitives may be bent");
  options.add("--outliers", arguments.outliers, parse_share, "SHARE",
              "Of the points, how many may belong to nothing: 0 to 0.9 (default 0.6 for one primitive, 0 for several)");
  options.add_flag("--inside", arguments.inside,
                   "The model lies within the solid of the mesh, which must be closed: fitted to, and proven");
  options.add_flag("--outside", arguments.outside,
                   "The model lies around it, a safe hull: fitted to, and proven; with --bend of one primitive alone");
  options.add("--seed", arguments.seed, whole_number<std::uint64_t>(0), "NUMBER", "Of samples and starts (default 1)");
  options.add("--units", arguments.units, "TEXT", "What the model file says of its units, \"mm\"");
  options.add_flag("--no-proof", arguments.no_proof, "Do not prove the deviation of a mesh, which takes a while");
  declare_report_files(options, arguments.report);
  add_device(options, arguments.device);
  add_json_of_enclosures(options, arguments.json);
  add_no_progress(options, arguments.no_progress);
}

ExitStatus run_recover(const RecoverArguments& arguments) {
  const RecoveryOptions options = options_of(arguments);
  check_usage(arguments);
  const OutputFile trial(arguments.output);  // known before all the work; leaves nothing behind
  const Stopwatch time;
  const Mesh input = read_input(arguments);
  watch_for_interruption();
  Found found = search(input, arguments, options);
  Recovery& recovery = found.recovery;
  recovery.model.units = arguments.units;
  write_model(arguments.output, recovery.model);
  if (recovery.interrupted) tell(fmt::format("interrupted; the best model so far is kept in {}", arguments.output));
  std::optional<Deviation> proven;
  if (!recovery.interrupted && !input.triangles.empty() && !arguments.no_proof) {
    // Of bent solids the mean takes very long.
    proven = proven_deviation(recovery.model, input,
                              {.device = arguments.device,
                               .no_progress = arguments.no_progress,
                               .statistics = is_union_of_convex(recovery.model)});
    if (proven->interrupted)
      tell(fmt::format("interrupted; the model is in {}, its deviation is wide", arguments.output));
  }
  const bool is_drawn = proven && write_report(arguments, recovery.model, input, *proven);
  const RecoverReport report{.recovery = recovery,
                             .of_mesh = !arguments.mesh.empty(),
                             .deviation = arguments.deviation,
                             .contained = found.contained,
                             .proven = proven,
                             .output = arguments.output,
                             .files = is_drawn ? arguments.report : ReportFiles(),
                             .seconds = time.seconds()};
  if (!recovery.interrupted && !report.reached())
    tell(fmt::format("--deviation {:.6g}: is not reached", *arguments.deviation));
  if (!recovery.interrupted && !report.is_contained()) tell(obstacle(*found.contained));
  fmt::print("{}", arguments.json ? json(report) : readable(report));
  return status_of(report);
}

}  // namespace verisq::command_line
