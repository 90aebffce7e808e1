/// Reads the problem, searches, proves what was found, writes and reports.
#include "host/command_line/fit_command.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <optional>
#include <system_error>
#include <tuple>
#include <utility>
#include <verisq/clearance.hpp>
#include <verisq/error.hpp>
#include <verisq/map_file.hpp>
#include <verisq/mesh_clearance.hpp>
#include <verisq/model_file.hpp>
#include <verisq/signed_distance.hpp>

#include "host/command_line/fit_problem.hpp"
#include "host/command_line/fit_summary.hpp"
#include "host/command_line/interruption.hpp"
#include "host/command_line/length_option.hpp"
#include "host/command_line/progress_bar.hpp"
#include "host/command_line/whole_number.hpp"
#include "host/files/output_file.hpp"

namespace verisq::command_line {
namespace {

constexpr double default_relative_tolerance = 1e-6;  // of the radius of the fitted model's bounding sphere
// Colours end at so many times the farthest distance that serves: what matters is near the implant.
constexpr double gaps_shown = 5.0;
// The depth of a cut needs many samples to be known closely, and none where nothing is cut.
constexpr double surface_coarseness = 10.0;

constexpr const char* closing_words =
    "Maximises F, the sum over the vertices of weight times f(distance): f is 1 at the wanted distance (0 for\n"
    "cementless completion, G for cemented), 1/2 at G (the tolerance) from it, and falls quickly inside the implant.\n"
    "The implant's centre moves by at most the translation range along each axis, and the implant turns about it by a\n"
    "rotation vector of at most the rotation range along each axis. Semi-axes that are intervals in the model file "
    "are\n"
    "sizes to choose from; of several --implant the best is chosen. The same seed on the same device gives the same\n"
    "pose.\n"
    "\n"
    "The search proves nothing. Of the pose that it found, every printed enclosure is proven: F, the signed distance "
    "of\n"
    "each vertex, the smallest one, the deepest penetration; of the triangles, too, whether they keep the limit "
    "between\n"
    "their vertices. An area's vertices are proven within the band that "
    "serves\n"
    "(from -P to G; for cemented completion G to within the tolerance), proven outside, or undecided. -o is a model\n"
    "file: `verisq map --model fitted.json --mesh F` gives the same enclosures.\n"
    "\n"
    "Ctrl-C ends the search: the best pose so far is proven and written. A second Ctrl-C stops at once; once the "
    "proof\n"
    "runs, -o is written already.\n"
    "\n"
    "Exit status: 0 every enclosure is at most the tolerance wide and nothing is proven deeper than the limit;\n"
    "3 finished, but not so; 2 bad usage or input; 130 interrupted by Ctrl-C.\n"
    "\n"
    "Examples:\n"
    "  verisq fit --implant stem_mm.json --mesh femur.stl -o fitted.json --map clearance.vtp --report clearance.html\n"
    "  verisq fit --implant size1.json --implant size2.json --mesh femur.ply --labels region --weight 2=5 -o "
    "fitted.json";

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

[[noreturn]] void refuse(const std::string& message) {
  throw Error(ErrorKind::input, message);
}

/// What is written must not be what is read, or written too.
void check_output(const std::string& option, const std::string& file, const FitArguments& arguments) {
  std::vector<std::string> inputs = arguments.implants;
  inputs.push_back(arguments.mesh);
  for (const std::string& input : inputs) {
    std::error_code missing;  // a file that does not exist is not overwritten
    if (std::filesystem::equivalent(input, file, missing))
      refuse(fmt::format("{} {}: would overwrite an input", option, file));
  }
  const OutputFile trial(file);  // known before all the work, not after it; leaves nothing behind
}

void check_outputs(const FitArguments& arguments) {
  check_output("-o", arguments.output, arguments);
  if (!arguments.map.empty()) check_output("--map", arguments.map, arguments);
  for (const std::string& input : arguments.implants) check_usage(arguments.report, {input, arguments.mesh});
  std::vector<std::string> outputs;
  for (const std::string& file : {arguments.output, arguments.map, arguments.report.html, arguments.report.png}) {
    if (file.empty()) continue;
    outputs.push_back(std::filesystem::absolute(file).lexically_normal().string());
    if (std::ranges::count(outputs, outputs.back()) > 1) refuse(fmt::format("{}: is the name of two outputs", file));
  }
}

void refuse_what_cannot_be_drawn(const FitArguments& arguments, const Mesh& mesh) {
  if (!arguments.report.any() || !mesh.triangles.empty()) return;
  refuse(fmt::format("{}: {}: has no triangles to draw", arguments.report.html.empty() ? "--png" : "--report",
                     arguments.mesh));
}

void tell_of_empty_areas(const Cavity& cavity) {
  std::vector<bool> used(cavity.areas.size());
  for (const std::uint32_t area : cavity.area_of) used[area] = true;
  for (std::size_t k = 0; k < used.size(); ++k) {
    if (!used[k]) fmt::print(stderr, "verisq: area {}: has no vertex of the mesh\n", cavity.areas[k].name);
  }
}

Fit search(FitProblem& problem, const FitArguments& arguments) {
  ProgressBar bar(!arguments.no_progress, "poses");
  FitOptions options = problem.options;
  options.interrupted = interrupted;
  options.progress = [&](const FitProgress& progress) {
    const std::string name = std::filesystem::path(arguments.implants[progress.implant]).filename().string();
    bar.update_state(std::isfinite(progress.objective) ? fmt::format("{}: F = {:.6g}", name, progress.objective)
                                                       : fmt::format("{}: no pose within the limit yet", name),
                     progress.done);
  };
  return fit(problem.series, problem.cavity, options);
}

double default_tolerance(const Model& model) {
  const double tolerance = default_relative_tolerance * bounding_radius(model);
  // An infinite tolerance would call every enclosure verified.
  if (!std::isfinite(tolerance)) refuse("--tol: give one, because the size of the model overflows");
  return tolerance;
}

struct Proof {
  Clearance clearance;
  std::optional<MeshClearance> surface;
  std::vector<MapResult> rows;
};

MeshClearance prove_surface(const FitProblem& problem, const Model& fitted) {
  return mesh_clearance(fitted, problem.mesh,
                        {.penetration_limit = problem.options.penetration_limit,
                         .tolerance = surface_coarseness * problem.options.surface_tolerance,
                         .limit_tolerance = problem.options.surface_tolerance,
                         .device = problem.options.device});
}

/// Never ended by the first Ctrl-C, which has kept its pose already. `map` is nothing when not asked for.
Proof prove(const FitProblem& problem, const Model& fitted, const MapOptions& options, bool show_progress,
            std::optional<MapWriter>& map) {
  ProgressBar bar(show_progress, "points");
  Proof proof{};
  const auto sink = [&](std::span<const Point> points, std::span<const MapResult> rows, std::span<const Certificate>) {
    if (map) map->append(points, rows);
    proof.rows.insert(proof.rows.end(), rows.begin(), rows.end());
    bar.update(proof.rows.size(),
               static_cast<double>(proof.rows.size()) / static_cast<double>(problem.cavity.points.size()));
  };
  proof.clearance = certified_clearance(fitted, problem.cavity, problem.options.fitness,
                                        problem.options.penetration_limit, options, sink);
  if (map) map->finish();
  if (!problem.cavity.triangles.empty()) proof.surface = prove_surface(problem, fitted);
  return proof;
}

void write_report(const FitProblem& problem, const FitSummary& summary, std::span<const MapResult> rows,
                  const FitArguments& arguments) {
  const auto name = [](const std::string& file) { return std::filesystem::path(file).filename().string(); };
  std::vector<std::string> area_names;
  for (const Area& area : problem.cavity.areas) area_names.push_back(area.name);
  write(arguments.report, {.title = fmt::format("{}: fit of {}", name(arguments.mesh), name(summary.implant)),
                           .bone = problem.mesh,
                           .rows = rows,
                           .implant = summary.fit.model,
                           .units = problem.units,
                           .summary = report_lines(summary),
                           .area_names = std::move(area_names),
                           .area_of = problem.cavity.area_of,
                           .range = gaps_shown * problem.options.fitness.serves.hi});
}

void explain(const FitSummary& summary) {
  const auto& [fit, clearance] = std::tie(summary.fit, summary.clearance);
  if (!fit.notice.empty()) fmt::print(stderr, "verisq: {}\n", fit.notice);
  if (clearance.map.notice != fit.notice) fmt::print(stderr, "verisq: {}\n", clearance.map.notice);
  if (fit.interrupted)
    fmt::print(stderr, "verisq: interrupted; the best pose so far is proven, and kept in {}\n", summary.output);
  if (clearance.proven_too_deep > 0) {
    fmt::print(stderr, "verisq: {} points are proven deeper inside the implant than the limit\n",
               clearance.proven_too_deep);
  }
  if (summary.surface && summary.surface->proven_too_deep > 0) {
    fmt::print(stderr, "verisq: {} triangles are proven to enter the implant deeper than the limit\n",
               summary.surface->proven_too_deep);
  }
}

ExitStatus status_of(const FitSummary& summary) {
  if (summary.fit.interrupted) return ExitStatus::interrupted;
  const bool as_asked = summary.clearance.map.wide == 0 && summary.clearance.proven_too_deep == 0 &&
                        (!summary.surface || summary.surface->proven_too_deep == 0);
  return as_asked ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace

const CLI::App& declare_fit(CLI::App& program, FitArguments& arguments) {
  CLI::App& fit = *program.add_subcommand("fit", "Find the best pose of an implant in a bone, and prove its clearance");
  fit.footer(closing_words);
  fit.add_option("--implant", arguments.implants,
                 "Model of posed superquadrics (verisq-model/1, JSON); repeat it for a series to choose from")
      ->required()
      ->allow_extra_args(false)
      ->option_text("FILE REQUIRED");
  fit.add_option("--mesh", arguments.mesh, "The bone: .stl .obj .ply .off; its vertices are fitted")
      ->required()
      ->option_text("FILE REQUIRED");
  fit.add_option("--completion", arguments.completion,
                 "cementless (default): as close as can be, at most the gap apart; or cemented: a layer of the gap")
      ->option_text("WHAT");
  fit.add_option("--gap", arguments.gap, "In model units (default 2 where the units are mm)")->option_text("NUMBER");
  fit.add_option("--gap-tolerance", arguments.gap_tolerance, "For cemented completion (default: half the gap)")
      ->option_text("NUMBER");
  fit.add_option("--penetration-limit", arguments.penetration_limit,
                 "No bone deeper inside the implant than this, in model units (default 0)")
      ->option_text("NUMBER");
  fit.add_option("--on", arguments.on,
                 "What keeps that limit: triangles (default where the mesh has any), the whole surface; or vertices")
      ->option_text("WHAT");
  fit.add_option("--pose-start", arguments.pose_start,
                 "Where the search begins: moves the implant as its file places it (default: leaves it there)")
      ->option_text("tx,ty,tz,qw,qx,qy,qz");
  fit.add_option("--translation-range", arguments.translation_range,
                 "From the start, in model units (default: half the diagonal of the mesh's bounding box)")
      ->option_text("NUMBER");
  fit.add_option("--rotation-range", arguments.rotation_range, "From the start, in degrees (default 30, at most 180)")
      ->option_text("DEGREES");
  fit.add_option("--seed", arguments.seed, "Of the sampled poses (default 1)")
      ->transform(whole_number("--seed", 0))
      ->option_text("NUMBER");
  fit.add_option("--samples", arguments.samples,
                 "How many poses the search samples first: 0 to 1000000000 (default 4096)")
      ->transform(whole_number("--samples", 0, 1'000'000'000))
      ->option_text("NUMBER");
  fit.add_option("--labels", arguments.labels,
                 "Areas are the values of this integer property of a .ply mesh's vertices, not the boxes of the model "
                 "file")
      ->option_text("PROPERTY");
  fit.add_option("--weight", arguments.weights,
                 "Weight of an area, by its name or label (elsewhere: of what no box holds); may be repeated")
      ->allow_extra_args(false)
      ->option_text("NAME=W");
  fit.add_option("--tol", arguments.tolerance,
                 "Largest width of a verified enclosure, in model units; 0 asks for the tightest.\n"
                 "Default: 1e-6 times the radius of the fitted model's bounding sphere")
      ->option_text("NUMBER");
  fit.add_option("--device", arguments.device,
                 "auto (default), host (no OpenCL), or an index or part of a name from `verisq devices`")
      ->option_text("DEVICE");
  fit.add_option("-o,--output", arguments.output, "The fitted model: .json")->required()->option_text("FILE REQUIRED");
  fit.add_option("--map", arguments.map, "The proven distance of every vertex, by extension: .csv .vtp .ply .json")
      ->option_text("FILE");
  declare_report_files(fit, arguments.report);
  fit.add_flag("--json", arguments.json, "Print the summary as one JSON object; what is not bounded is null");
  fit.add_flag("--no-progress", arguments.no_progress, "No progress bar, even on a terminal");
  return fit;
}

ExitStatus run_fit(const FitArguments& arguments) {
  check_outputs(arguments);
  std::optional<double> tolerance;
  if (arguments.tolerance) tolerance = parse_length("--tol", *arguments.tolerance);
  FitProblem problem = read_fit_problem(arguments);
  refuse_what_cannot_be_drawn(arguments, problem.mesh);
  tell_of_empty_areas(problem.cavity);

  std::optional<MapWriter> map;  // before the search: an unknown format is refused, not met after all the work
  if (!arguments.map.empty()) map.emplace(arguments.map, &problem.mesh);

  watch_for_interruption();
  const auto start = Clock::now();
  Fit found = search(problem, arguments);
  const double search_seconds = seconds_since(start);
  write_model(arguments.output, found.model);

  if (!tolerance) tolerance = default_tolerance(found.model);
  const auto proof_start = Clock::now();
  Proof proof =
      prove(problem, found.model, {.tolerance = *tolerance, .device = arguments.device}, !arguments.no_progress, map);
  const std::size_t implant = found.implant;
  const FitSummary summary{.fit = std::move(found),
                           .clearance = std::move(proof.clearance),
                           .surface = std::move(proof.surface),
                           .implant = arguments.implants[implant],
                           .implants = arguments.implants.size(),
                           .sized = !is_exact(problem.series[implant]),
                           .penetration_limit = problem.options.penetration_limit,
                           .tolerance = *tolerance,
                           .units = problem.units,
                           .search_seconds = search_seconds,
                           .proof_seconds = seconds_since(proof_start),
                           .output = arguments.output,
                           .map = arguments.map};
  explain(summary);
  if (arguments.report.any()) write_report(problem, summary, proof.rows, arguments);
  fmt::print("{}", arguments.json ? json(summary) : readable(summary));
  return status_of(summary);
}

}  // namespace verisq::command_line
