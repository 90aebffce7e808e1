/// `verisq fit`: its options, the request of the fit, and its run.
#include "host/command_line/fit_command.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <tuple>
#include <utility>
#include <verisq/distance.hpp>
#include <verisq/features.hpp>
#include <verisq/files.hpp>
#include <verisq/fit_solution.hpp>
#include <verisq/map_file.hpp>

#include "host/command_line/inputs.hpp"
#include "host/command_line/options.hpp"
#include "host/command_line/outputs.hpp"
#include "host/command_line/run.hpp"
#include "host/command_line/shared_inputs.hpp"
#include "host/errors/refusal.hpp"
#include "host/files/output_file.hpp"

namespace verisq::command_line {
namespace {

std::optional<FitSurface> surface_named(const FitArguments& arguments) {
  const std::array given{arguments.cavity, arguments.bone, arguments.any_side};
  if (std::ranges::count(given, true) > 1) refuse("give only one of --cavity, --bone and --any-side");
  if (arguments.cavity) return FitSurface::cavity;
  if (arguments.bone) return FitSurface::bone;
  return arguments.any_side ? std::optional(FitSurface::unsided) : std::nullopt;
}

FitLandmarks bone_landmarks(const FitArguments& arguments) {
  const LandmarkFile file = read_landmarks(arguments.landmarks);
  return {arguments.landmarks, file.landmarks, file.side, arguments.landmark_radius};
}

}  // namespace

FitRequest read_fit_request(const FitArguments& arguments) {
  FitRequest request{.implants = {},
                     .mesh_name = arguments.mesh,
                     .mesh = {},
                     .surface = surface_named(arguments),
                     .resection = arguments.resection,
                     .crossing = arguments.crossing,
                     .outside = arguments.outside,
                     .kept = arguments.kept,
                     .objective = arguments.objective,
                     .implant_contact = arguments.implant_contact,
                     .completion = arguments.completion,
                     .gap = arguments.gap,
                     .gap_tolerance = arguments.gap_tolerance,
                     .penetration_limit = arguments.penetration_limit,
                     .pose_start = arguments.pose_start.value_or(Pose{}),
                     .translation_range = arguments.translation_range,
                     .rotation_range = arguments.rotation_range,
                     .seed = arguments.seed,
                     .samples = arguments.samples,
                     .weights = arguments.weights,
                     .device = arguments.device};
  for (const std::string& file : arguments.implants) {
    request.implants.push_back({file, read_uncertain_model(file), read_model_landmarks(file), read_areas(file)});
  }
  if (!arguments.landmarks.empty()) request.landmarks = bone_landmarks(arguments);
  if (arguments.on) request.on_triangles = *arguments.on == MapElements::triangles;
  request.mesh = read_mesh(arguments.mesh);
  for (const FitImplant& implant : request.implants)
    tell_of_other_size(bracket(implant.model).largest, implant.name, request.mesh.vertices, arguments.mesh);
  if (arguments.labels) request.labelled = read_labelled_cavity(arguments.mesh, *arguments.labels, arguments.weights);
  return request;
}

namespace {

constexpr std::size_t most_samples = 1'000'000'000;
// Colours end at so many times the largest useful distance: the relevant places are near the implant.
constexpr double gaps_shown = 5.0;

constexpr const char* closing_words =
    "Maximises F, the sum over the vertices of weight times f(distance): f is 1 at the wanted distance (0 for\n"
    "cementless completion, G for cemented), 1/2 at G (the tolerance) from it, and falls quickly inside the implant.\n"
    "The implant's centre moves by at most the translation range along each axis, and the implant turns about it by a\n"
    "rotation vector of at most the rotation range along each axis. Semi-axes that are intervals in the model file\n"
    "are sizes to choose from; of several --implant the best is chosen. The same seed on the same device gives the\n"
    "same pose. With --objective size the largest implant (by the volumes of its primitives) is tried first, and the\n"
    "first of which all that is asked is proven is chosen; that no larger one can keep it is not proven.\n"
    "\n"
    "The search proves nothing. Of the pose that it found, every printed enclosure is proven: F, the signed distance\n"
    "of each vertex, the smallest one, the deepest penetration; of the triangles, too, whether they keep the limit\n"
    "between their vertices. An area's vertices are proven within the band that serves (from -P to G; for cemented\n"
    "completion G to within the tolerance), proven outside, or undecided. -o is a model file: `verisq map --model\n"
    "fitted.json --mesh F` gives the same enclosures.\n"
    "\n"
    "Beside the bone an implant touches nothing: say by --cavity or --bone on which side it belongs. Of each\n"
    "primitive it is proven, too, whether all of it (what lies deeper in it than the penetration limit) is there; a\n"
    "mesh with rims is closed over them. A neck and a head pass through the opening: name them by --crossing.\n"
    "\n"
    "--bound looks at every box of poses of the range, and leaves out those of which it is proven that a vertex is\n"
    "too deep, or that F is no better. Its bound holds for all poses that keep the limit at the vertices, whatever\n"
    "else is asked of them.\n"
    "\n"
    "--certificate-file, --map and --surface-map keep what proves it again: `verisq check --certificate FILE\n"
    "--model FITTED --mesh F --map MAP --surface-map MAP` proves every distance, and F, the smallest distance of the\n"
    "vertices and of the whole surface, the deepest penetration, how many vertices keep the limit and the numbers of\n"
    "every area; and on which side of the mesh each primitive lies. --bound-certificate-file does the same for the\n"
    "bound, from the implants' files and the mesh, --contact-certificate-file for the mesh's areas in contact and,\n"
    "with --implant-contact, what of the implant's own surface is. What the implant changes is proved by `verisq\n"
    "features --landmarks F --implant FITTED --certificate-file`.\n"
    "\n"
    "Ctrl-C ends the search, or the bound: the best pose so far is proven and written. One that comes later ends the\n"
    "proof, and -o is written already. A second Ctrl-C stops at once.\n"
    "\n"
    "Exit status: 0 every enclosure is at most the tolerance wide, nothing is proven deeper than the limit, and every\n"
    "primitive is proven to lie on its side, every change to be within --keep, F to be as near to the best as --bound\n"
    "asks; 3 finished, but not so; 2 bad usage or input; 130 interrupted by Ctrl-C.\n"
    "\n"
    "Examples:\n"
    "  verisq fit --implant stem_mm.json --mesh canal.stl --cavity --resection 105,0,-120,-0.7,0,0.7 \\\n"
    "    --crossing neck --crossing head -o fitted.json --map clearance.vtp --report clearance.html\n"
    "  verisq fit --implant size1.json --implant size2.json --mesh coxa.ply --bone --labels region --weight 2=5 \\\n"
    "    -o fitted.json";

/// No output may be an input, or another output.
void check_outputs(const FitArguments& arguments) {
  std::vector<std::string> inputs = arguments.implants;
  inputs.insert(inputs.end(), arguments.instruments.begin(), arguments.instruments.end());
  inputs.push_back(arguments.mesh);
  const auto check_output = [&inputs](const char* option, const std::string& file) {
    refuse_to_overwrite(option, file, inputs);
    const OutputFile trial(file);  // known before all the work, not after it; leaves nothing behind
  };
  check_output("-o", arguments.output);
  if (!arguments.map.empty()) check_output("--map", arguments.map);
  if (!arguments.surface_map.empty()) check_output("--surface-map", arguments.surface_map);
  check_certificate_file(arguments.certificate_file, inputs);
  check_certificate_file(arguments.bound_certificate, inputs, "--bound-certificate-file");
  check_certificate_file(arguments.contact_certificate, inputs, "--contact-certificate-file");
  check_usage(arguments.report, inputs,
              {arguments.output, arguments.map, arguments.surface_map, arguments.certificate_file,
               arguments.bound_certificate, arguments.contact_certificate});
}

void refuse_what_cannot_be_drawn(const FitArguments& arguments, const Mesh& mesh) {
  if (!arguments.report.any() || !mesh.triangles.empty()) return;
  refuse(fmt::format("{}: {}: has no triangles to draw", arguments.report.html.empty() ? "--png" : "--report",
                     arguments.mesh));
}

void write_fitted(const FitProblem& problem, const FitArguments& arguments, const Fit& fit) {
  write_model(arguments.output, fit.model, posed(problem.implant_landmarks[fit.implant], fit.pose));
}

/// One line at a time: the search's, or the bound's.
class FitProgressBars {
 public:
  FitProgressBars(const FitProblem& problem, const FitArguments& arguments)
      : problem_(problem), arguments_(arguments) {}

  void show(const FitProgress& progress) {
    begin(search_, bound_, "poses");
    const std::string name = std::filesystem::path(problem_.names[progress.implant]).filename().string();
    search_->update_state(std::isfinite(progress.objective) ? fmt::format("{}: F = {:.6g}", name, progress.objective)
                                                            : fmt::format("{}: no pose within the limit yet", name),
                          progress.done);
  }

  /// Shows the progress of the bound after `seconds`; `known` is the known objective.
  void show(const FitBoundProgress& progress, double known, double seconds) {
    begin(bound_, search_, "boxes");
    bound_->update_state(fmt::format("F of any pose at most {:.6g}, found {:.6g}", progress.upper, known),
                         std::min(seconds / arguments_.bound_time, 1.0));
  }

  /// To be called before anything else is printed.
  void clear() {
    search_.reset();
    bound_.reset();
  }

 private:
  void begin(std::optional<ProgressBar>& bar, std::optional<ProgressBar>& other, const char* unit) const {
    other.reset();
    if (!bar) bar.emplace(!arguments_.no_progress, unit);
  }

  const FitProblem& problem_;
  const FitArguments& arguments_;
  std::optional<ProgressBar> search_;
  std::optional<ProgressBar> bound_;
};

/// Each fit that is found is written at once.
FitSolution search_and_bound(const FitProblem& problem, const FitArguments& arguments, const Deadline& all) {
  FitProgressBars bars(problem, arguments);
  Deadline limit(arguments.bound_time);
  Stopwatch watch;
  std::optional<double> known;
  FitSolutionOptions options{
      .interrupted = interrupted, .out_of_time = limit.out_of_time(), .search_out_of_time = all.out_of_time()};
  if (arguments.bound) options.gap = *arguments.bound / 100.0;
  options.progress = [&](const FitProgress& progress) { bars.show(progress); };
  options.bound_progress = [&](const FitBoundProgress& progress) { bars.show(progress, *known, watch.seconds()); };
  options.found = [&](const Fit& found) {
    bars.clear();
    if (known) {
      tell(fmt::format("the bound came across a better pose: F = {:.6g}, not {:.6g}", found.objective, *known));
    } else {
      limit.start();
      watch = {};
    }
    known = found.objective;
    write_fitted(problem, arguments, found);
  };
  return solve_fit(problem, options);
}

double tolerance_of(const FitArguments& arguments, const Model& fitted) {
  return arguments.tolerance ? *arguments.tolerance
                             : default_tolerance(tolerance_of_distances, bounding_radius(fitted), "the model");
}

/// The proof, and the rows of all vertices.
struct MappedProof {
  FitProof proof;
  std::vector<MapResult> rows;
  std::vector<Certificate> certificates;  ///< none, or one a row
};

/// Proves all vertices, or those before an interruption. `map` is nothing if not requested.
MappedProof prove(const FitProblem& problem, const FitSolution& solution, const MapOptions& options, bool show_progress,
                  std::optional<MapWriter>& map) {
  ProgressBar bar(show_progress, "points");
  std::vector<MapResult> all;
  std::vector<Certificate> all_certificates;
  const std::size_t size = problem.cavity.points.size();
  const auto sink = [&](std::span<const Point> points, std::span<const MapResult> rows,
                        std::span<const Certificate> certificates) {
    if (map) map->append(points, rows, certificates);
    all_certificates.insert(all_certificates.end(), certificates.begin(), certificates.end());
    all.insert(all.end(), rows.begin(), rows.end());
    bar.update(all.size(), static_cast<double>(all.size()) / static_cast<double>(size));
  };
  FitProof proof = prove_fit(problem, solution, options, sink);
  if (map && !proof.clearance.map.interrupted) map->finish();
  return {std::move(proof), std::move(all), std::move(all_certificates)};
}

std::optional<BestPossible> compared(const FitSolution& solution, const FitProof& proof,
                                     const FitArguments& arguments) {
  if (!solution.bound) return std::nullopt;
  return BestPossible{
      .bound = *solution.bound, .asked = *arguments.bound / 100.0, .gap = proof.gap, .seconds = solution.bound_seconds};
}

std::vector<SurfaceSide> sides_required(const FitProblem& problem, std::size_t implant) {
  return problem.options.sides.empty() ? std::vector<SurfaceSide>() : problem.options.sides[implant];
}

void write_report(const FitProblem& problem, const FitSummary& summary, const MappedProof& proof,
                  const FitArguments& arguments) {
  const auto name = [](const std::string& file) { return std::filesystem::path(file).filename().string(); };
  std::vector<std::string> area_names;
  for (const Area& area : problem.cavity.areas) area_names.push_back(area.name);
  std::optional<ReportProof> page_proof;
  if (certifies(arguments)) {
    page_proof =
        ReportProof{.certificates = proof.certificates, .model_file = arguments.output, .mesh_file = arguments.mesh};
  }
  write(arguments.report, {.title = fmt::format("{}: fit of {}", name(arguments.mesh), name(summary.implant)),
                           .bone = problem.mesh,
                           .rows = proof.rows,
                           .implant = summary.fit.model,
                           .units = problem.units,
                           .summary = report_lines(summary),
                           .area_names = std::move(area_names),
                           .area_of = problem.cavity.area_of,
                           .range = gaps_shown * problem.options.fitness.serves.hi,
                           .proof = page_proof});
}

void explain(const FitSummary& summary) {
  const auto& [fit, clearance] = std::tie(summary.fit, summary.clearance);
  tell_notice(fit.notice);
  if (clearance.map.notice != fit.notice) tell_notice(clearance.map.notice);
  if (fit.out_of_time) tell("the time limit is reached: the search ended early, with the best pose so far");
  if (!summary.unfinished.empty()) {
    tell(fmt::format("the time limit is reached: what is not proven yet stays open: {}",
                     fmt::join(summary.unfinished, ", ")));
  }
  if (fit.interrupted) tell(fmt::format("interrupted; the best pose so far is proven, and kept in {}", summary.output));
  if (clearance.proven_too_deep > 0) {
    tell(fmt::format("{} points are proven deeper inside the implant than the limit", clearance.proven_too_deep));
  }
  if (summary.surface && summary.surface->proven_too_deep > 0) {
    tell(fmt::format("{} triangles are proven to enter the implant deeper than the limit",
                     summary.surface->proven_too_deep));
  }
  for (const std::string& sentence : broken_sides(summary)) tell(sentence);
  for (const std::string& sentence : broken_features(summary)) tell(sentence);
  for (const std::string& sentence : broken_contacts(summary)) tell(sentence);
}

/// A hint, if no pose was found that keeps the limit and its sides, and no start was given: usually the implant's file
/// has another frame than the bone's.
void hint_where_to_look(const FitSummary& summary, const FitArguments& arguments) {
  const bool found = summary.fit.within_limit && broken_sides(summary).empty();
  if (found || summary.fit.interrupted || arguments.pose_start || arguments.translation_range) return;
  tell(
      "the search began where the implant's file places it, and went up to half the mesh's size from there: where the "
      "implant belongs somewhere else, say by --pose-start where to begin, and by --translation-range and "
      "--rotation-range how far to look");
}

/// The pose is kept; half of its proof is worth nothing.
ExitStatus end_without_proof(const FitArguments& arguments) {
  tell(fmt::format("interrupted; the best pose is kept in {}, and is not proven", arguments.output));
  return ExitStatus::interrupted;
}

bool was_interrupted(const FitSolution& solution) {
  return solution.fit.interrupted || (solution.bound && solution.bound->interrupted);
}

std::string parse_name(std::string_view option, const std::string& text) {
  if (text.empty()) refuse(fmt::format("{}: the name is empty", option));
  return text;
}

Area parse_weight(std::string_view option, const std::string& text) {
  const std::size_t equals = text.rfind('=');
  if (equals == std::string::npos || equals == 0) refuse(fmt::format("{}: {} is not NAME=W", option, text));
  return {text.substr(0, equals), parse_length(fmt::format("{} {}", option, text), text.substr(equals + 1))};
}

double parse_percentage(std::string_view option, const std::string& text) {
  const double percentage = parse_positive_length(option, text);
  if (percentage >= 100.0) refuse(fmt::format("{}: {} is not below 100", option, text));
  return percentage;
}

double parse_rotation(std::string_view option, const std::string& text) {
  const double degrees = parse_length(option, text);
  if (degrees > 180.0) refuse(fmt::format("{}: {} is above 180", option, text));
  return degrees;
}

/// The side of the mesh on which the implant must be.
void declare_sides(Options& options, FitArguments& arguments) {
  options.add_flag("--cavity", arguments.cavity,
                   "The mesh is the surface of a cavity: the implant has to lie inside it (default for a closed mesh "
                   "whose normals point inward)");
  options.add_flag("--bone", arguments.bone, "The mesh bounds bone: the implant has to lie outside of it");
  options.add_flag("--any-side", arguments.any_side,
                   "The implant may lie on any side of the mesh, beside the bone too");
  options.add("--resection", arguments.resection, parse_plane, "x,y,z,nx,ny,nz",
              "Plane in which the bone is cut, by a point and a normal: what lies beyond it, where the normal points, "
              "is left out");
  options.add_each("--crossing", arguments.crossing, parse_name, "PRIMITIVE",
                   "One that may pass through the opening, like a neck or a head, and lie anywhere; may be repeated");
  options.add_each("--outside", arguments.outside, parse_name, "PRIMITIVE",
                   "One that has to lie outside of the cavity; may be repeated");
}

KeptFeature parse_kept(std::string_view option, const std::string& text) {
  const auto [name, range] = parse_named_range(option, text);
  return {name, range};
}

/// The features of the bone that are to be preserved.
void declare_preservation(Options& options, FitArguments& arguments) {
  options.add("--landmarks", arguments.landmarks, "FILE",
              "The bone's, as `verisq features -o` writes them: says what the implant changes, of the points that its "
              "own file names, else of the centres of its primitives head and neck");
  options.add("--landmark-radius", arguments.landmark_radius, parse_length, "NUMBER",
              "How well they are known, in model units (default 0)");
  options.add_each("--keep", arguments.kept, parse_kept, "NAME=LO,HI",
                   "A change that has to be within these ends: offset_change, length_change, head_distance, in model "
                   "units; version_change, ccd_change, implant_ccd, implant_tilt, in degrees; or an area in contact, "
                   "in percent: contact (of the mesh), contact:AREA, implant_contact; may be repeated");
  options.add_flag("--implant-contact", arguments.implant_contact,
                   "Encloses how much of the implant's own surface is in contact, too");
}

/// The objective of the pose, and the conditions of allowed poses.
void declare_aims(Options& options, FitArguments& arguments) {
  options.add("--objective", arguments.objective,
              choice<FitObjective>({{"fitness", FitObjective::fitness}, {"size", FitObjective::size}}), "WHAT",
              "fitness (default): the largest F; or size: the largest implant of the series, or sizes, of which all "
              "that is asked is proven");
  options.add("--completion", arguments.completion,
              choice<Completion>({{"cementless", Completion::cementless}, {"cemented", Completion::cemented}}), "WHAT",
              "cementless (default): as close as can be, at most the gap apart; or cemented: a layer of the gap");
  options.add("--gap", arguments.gap, parse_length, "NUMBER", "In model units (default 2 where the units are mm)");
  options.add("--gap-tolerance", arguments.gap_tolerance, parse_positive_length, "NUMBER",
              "For cemented completion (default: half the gap)");
  options.add("--penetration-limit", arguments.penetration_limit, parse_length, "NUMBER",
              "No bone deeper inside the implant than this, in model units (default 0)");
  options.add("--on", arguments.on,
              choice<MapElements>({{"vertices", MapElements::vertices}, {"triangles", MapElements::triangles}}), "WHAT",
              "What keeps that limit: triangles (default where the mesh has any), the whole surface; or vertices");
}

/// The range in which poses are searched.
void declare_search(Options& options, FitArguments& arguments) {
  options.add("--pose-start", arguments.pose_start, parse_pose, "tx,ty,tz,qw,qx,qy,qz",
              "Where the search begins: moves the implant as its file places it (default: leaves it there)");
  options.add("--translation-range", arguments.translation_range, parse_length, "NUMBER",
              "From the start, in model units (default: half the diagonal of the mesh's bounding box)");
  options.add("--rotation-range", arguments.rotation_range, parse_rotation, "DEGREES",
              "From the start, in degrees (default 30, at most 180)");
  options.add("--bound", arguments.bound, parse_percentage, "PERCENT",
              "Proves that no pose of the range has an F larger than this one's by more than so much of it; sizes must "
              "be exact");
  options.add("--bound-time", arguments.bound_time, parse_time_limit, "SECONDS",
              "Ends that with what is proven by then (default 300); where it came across a better pose, that is "
              "refined, which --time-limit ends");
  options.add("--time-limit", arguments.time_limit, parse_time_limit, "SECONDS",
              "Ends the search, the bound and the proofs this long after the search begins: what is proven by then "
              "stays proven, and what is left open is named (default: none)");
  options.add("--bound-certificate-file", arguments.bound_certificate, "FILE",
              "What proves the bound again, for `verisq check --certificate` with the implants and the mesh: .json");
  options.add("--seed", arguments.seed, whole_number<std::uint64_t>(0), "NUMBER", "Of the sampled poses (default 1)");
  options.add("--samples", arguments.samples, whole_number<std::size_t>(1, most_samples), "NUMBER",
              fmt::format("How many poses the search samples first: 1 to {} (default 4096)", most_samples));
}

}  // namespace

void declare_fit(Options& options, FitArguments& arguments) {
  options.explain(closing_words);
  options.require_each(
      "--implant", arguments.implants, "FILE",
      "Model of posed superquadrics, tapered or not (verisq-model/1, JSON), or a closed mesh (.stl .obj .ply .off .vtp "
      ".vtk); repeat it for a series to choose from");
  options.require("--mesh", arguments.mesh, "FILE", "The bone: .stl .obj .ply .off .vtp .vtk; its vertices are fitted");
  options.add_each(
      "--instrument", arguments.instruments, parse_name, "FILE",
      "The rasp of an implant, or what else prepares its bed, as a model in the implant's frame: one for "
      "each --implant, in the same order. Proves how deep the chosen one's cuts, where the implant lies; the exit "
      "status does not depend on it");
  declare_sides(options, arguments);
  declare_aims(options, arguments);
  declare_preservation(options, arguments);
  declare_search(options, arguments);
  options.add("--labels", arguments.labels, "PROPERTY",
              "Areas are the values of this integer property of a .ply mesh's vertices, not the boxes of the model "
              "file");
  options.add_each("--weight", arguments.weights, parse_weight, "NAME=W",
                   "Weight of an area, by its name or label (elsewhere: of what no box holds); may be repeated");
  add_tolerance(options, arguments.tolerance, "the fitted model");
  add_device(options, arguments.device);
  options.require("-o,--output", arguments.output, "FILE", "The fitted model: .json");
  options.add("--map", arguments.map, "FILE",
              "The proven distance of every vertex, by extension: .csv .npy .vtp .ply .json");
  declare_certificates(options, arguments);
  declare_contact_certificate(options, arguments);
  declare_report_files(options, arguments.report);
  add_json_of_enclosures(options, arguments.json);
  add_no_progress(options, arguments.no_progress);
}

namespace {

FitProblem checked_problem(const FitArguments& arguments) {
  check_outputs(arguments);
  check_certificates(arguments);
  check_contact_certificate(arguments);
  FitProblem problem = fit_problem(read_fit_request(arguments));
  refuse_what_cannot_be_drawn(arguments, problem.mesh);
  refuse_what_has_no_certificates(problem, arguments);
  refuse_what_has_no_contact(problem, arguments);
  return problem;
}

/// All members but those measured or written after the proofs: the instrument, seconds, certificates.
FitSummary summary_of(const FitProblem& problem, const FitSolution& solution, const FitProof& proof,
                      const FitArguments& arguments) {
  const Fit& found = solution.fit;
  return {.fit = found,
          .clearance = proof.clearance,
          .surface = proof.surface,
          .instrument = {},
          .side_of = problem.surface,
          .required_sides = sides_required(problem, found.implant),
          .sides = proof.sides,
          .changes = proof.changes,
          .kept = problem.kept,
          .contact = proof.contact,
          .contact_distance = problem.options.fitness.serves.hi,
          .conditions = proof.conditions,
          .unfinished = proof.unfinished,
          .trials = solution.trials,
          .names = problem.names,
          .maximised = problem.options.objective,
          .landmark_radius = arguments.landmark_radius,
          .implant = problem.names[found.implant],
          .implants = problem.series.size(),
          .sized = !is_exact(problem.series[found.implant]),
          .best = compared(solution, proof, arguments),
          .penetration_limit = problem.options.penetration_limit,
          .tolerance = tolerance_of(arguments, found.model),
          .units = problem.units,
          .search_seconds = 0.0,
          .proof_seconds = 0.0,
          .output = arguments.output,
          .map = arguments.map,
          .surface_map = arguments.surface_map,
          .certificate_file = arguments.certificate_file,
          .bound_certificate = arguments.bound_certificate};
}

/// True if a requested certificate is not written, or proves less than requested.
bool lacks_certificates(const FitSummary& summary, ContactFile contact, ExitStatus of_rows) {
  const bool lacks_bound = summary.best && !summary.bound_certificate.empty() && !summary.certified_upper;
  return lacks_bound || of_rows == ExitStatus::unverified || contact == ContactFile::too_large ||
         contact == ContactFile::out_of_time;
}

ExitStatus status_of(const FitProblem& problem, const FitSolution& solution, const FitProof& proof,
                     const FitArguments& arguments) {
  const std::optional<double> gap = arguments.bound ? std::optional(*arguments.bound / 100.0) : std::nullopt;
  return is_as_asked(problem, solution, proof, gap) ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace

ExitStatus run_fit(const FitArguments& arguments) {
  const FitProblem problem = checked_problem(arguments);
  const std::vector<Instrument> instruments = read_instruments(problem, arguments);
  for (const std::string& notice : problem.notices) tell(notice);

  std::optional<MapWriter> map;  // before the search: an unknown format is refused, not met after all the work
  if (!arguments.map.empty()) map.emplace(arguments.map, &problem.mesh, MapForm{.contents = contents_of(arguments)});

  watch_for_interruption();
  // A Ctrl-C that ends the search has its pose proven; one that comes later ends the proofs.
  Deadline limit(arguments.time_limit, interrupted);
  limit.start();
  const Stopwatch search_time;
  const FitSolution solution = search_and_bound(problem, arguments, limit);
  const Fit& found = solution.fit;
  const double search_seconds = search_time.seconds() - solution.bound_seconds;

  const double tolerance = tolerance_of(arguments, found.model);
  const auto proofs_interrupted = [ended = interrupted()] { return !ended && interrupted(); };
  const std::optional<double> certified_upper = write_bound_certificate(problem, solution, limit, arguments);
  const Stopwatch proof_time;
  const MappedProof mapped = prove(problem, solution,
                                   {.tolerance = tolerance,
                                    .device = arguments.device,
                                    .certificates = certifies(arguments),
                                    .covers = certifies(arguments),
                                    .interrupted = proofs_interrupted,
                                    .out_of_time = limit.out_of_time()},
                                   !arguments.no_progress, map);
  const FitProof& proof = mapped.proof;
  if (!proof.unfinished.empty() && proofs_interrupted()) return end_without_proof(arguments);
  std::optional<InstrumentClearance> instrument;
  const auto ended = either(proofs_interrupted, limit.out_of_time());
  if (!instruments.empty()) instrument = prove_instrument(problem, found, instruments[found.implant], ended);
  const double proof_seconds = proof_time.seconds();
  const ContactFile contact_file = write_contact_certificate(problem, found, proof, limit, arguments);
  FitSummary summary = summary_of(problem, solution, proof, arguments);
  summary.instrument = instrument;
  summary.search_seconds = search_seconds;
  summary.proof_seconds = proof_seconds;
  summary.certified_upper = certified_upper;
  if (contact_file == ContactFile::written) summary.contact_certificate = arguments.contact_certificate;
  explain(summary);
  hint_where_to_look(summary, arguments);
  if (arguments.report.any()) write_report(problem, summary, mapped, arguments);
  std::vector<SideClaim> sides;
  if (proof.sides) sides = claims_of(*proof.sides, summary.required_sides);
  const ExitStatus certified = write_certificates(problem, found.model, proof.clearance, std::move(sides),
                                                  {.tolerance = tolerance,
                                                   .device = arguments.device,
                                                   .interrupted = proofs_interrupted,
                                                   .out_of_time = limit.out_of_time()},
                                                  arguments);
  fmt::print("{}", arguments.json ? json(summary) : readable(summary));
  if (was_interrupted(solution) || proofs_interrupted() || certified == ExitStatus::interrupted ||
      contact_file == ContactFile::interrupted)
    return ExitStatus::interrupted;
  return lacks_certificates(summary, contact_file, certified) ? ExitStatus::unverified
                                                              : status_of(problem, solution, proof, arguments);
}

Command fit_command() {
  return command("fit", "Find the best pose of an implant in a bone, and prove its clearance", declare_fit, run_fit);
}

}  // namespace verisq::command_line
