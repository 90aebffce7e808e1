/// `verisq recover`: a model from a point cloud or a mesh.
#include <fmt/core.h>
#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/certificate_file.hpp>
#include <verisq/clearance.hpp>
#include <verisq/deviation.hpp>
#include <verisq/error.hpp>
#include <verisq/files.hpp>
#include <verisq/recovery.hpp>

#include "host/command_line/deviation_command.hpp"
#include "host/command_line/inputs.hpp"
#include "host/command_line/options.hpp"
#include "host/command_line/outputs.hpp"
#include "host/command_line/run.hpp"
#include "host/command_line/summaries.hpp"
#include "host/errors/refusal.hpp"
#include "host/files/output_file.hpp"
#include "host/threads/parallel.hpp"

namespace verisq::command_line {
namespace {

// The summary of a recovery on the standard output: for people, or as one JSON object.

/// The requested containment and its result.
struct ContainedWords {
  Containment containment;
  ContainmentProof proof;
  std::size_t proofs;  ///< the number of proofs that were tried
};

/// Without its dashes.
[[nodiscard]] std::string option_of(Containment containment);

struct RecoverReport {
  const Recovery& recovery;
  bool of_mesh;                     ///< else of a cloud
  std::optional<double> deviation;  ///< requested
  std::optional<ContainedWords> contained;
  std::optional<Deviation> proven;  ///< of the mesh
  std::string output;               ///< the model file
  ReportFiles files;                ///< those that were written
  std::string certificate;          ///< likewise; empty: none
  double seconds;

  /// Returns whether the model is as near as requested, by estimate; true if nothing was requested.
  [[nodiscard]] bool reached() const;

  /// Returns whether the model is proven to be where it was requested to be; true if nothing was requested.
  [[nodiscard]] bool is_contained() const { return !contained || contained->proof.proven; }
};

/// As typed; `run_recover` checks what depends on several options.
struct RecoverArguments {
  std::string points;  ///< empty when `mesh` is given
  std::string mesh;    ///< empty when `points` is given
  std::string output;
  std::optional<std::size_t> primitives;
  std::optional<double> deviation;
  bool taper = false;
  bool bend = false;
  std::optional<double> outliers;
  bool inside = false;
  bool outside = false;
  std::uint64_t seed = 1;
  std::string units;
  std::string device = "auto";
  std::string certificate_file;  ///< empty: none
  bool no_proof = false;
  ReportFiles report;
  std::optional<double> time_limit;  ///< in seconds
  bool json = false;
  bool no_progress = false;
};

std::string columns(const EstimatedDeviation& deviation) {
  return fmt::format("{:>12.4g}{:>12.4g}{:>12.4g}", deviation.mean, deviation.percentile_95, deviation.largest);
}

std::string table(const RecoverReport& report) {
  std::string text = fmt::format("{:<12}{:>12}{:>12}{:>12}", "primitives", "mean", "95 %", "largest");
  if (report.of_mesh) text += fmt::format("{:>12}{:>12}{:>12}", "back: mean", "95 %", "largest");
  text += "\n";
  for (const RecoveryStage& stage : report.recovery.stages) {
    const std::string name = stage.containment ? fmt::format("{}, {}", stage.primitives, option_of(*stage.containment))
                                               : fmt::format("{}", stage.primitives);
    text += fmt::format("{:<12}{}", name, columns(stage.to_model));
    if (stage.to_mesh) text += columns(*stage.to_mesh);
    text += "\n";
  }
  return text;
}

/// The lines of the proven deviation, both ways.
std::string proven_lines(const Deviation& proven, const std::string& units) {
  std::string text;
  if (proven.from_mesh) {
    const DistanceStatistics& mesh = *proven.from_mesh;
    text += fmt::format("mesh to model      largest in {}{}, proven", outward_digits(mesh.largest), units);
    if (mesh.mean) text += fmt::format("; mean {}{}", outward_digits(*mesh.mean), units);
    if (!mesh.percentiles.empty()) text += fmt::format("; 95 % {}{}", outward_digits(mesh.percentiles[0]), units);
    text += "\n";
  }
  if (proven.from_model)
    text +=
        fmt::format("model to mesh      largest in {}{}, proven\n", outward_digits(proven.from_model->largest), units);
  return text;
}

/// The line of the containment, which covers all triangles.
std::string contained_line(const ContainedWords& contained) {
  const char* const word = contained.containment == Containment::within ? "inside the mesh" : "outside the mesh";
  if (!contained.proof.proven) return fmt::format("{:<19}not proven\n", word);
  const char* const what = contained.containment == Containment::within
                               ? "every point of the model in the mesh's solid"
                               : "every point of the mesh's solid in the model";
  return fmt::format("{:<19}proven: {}\n", word, what);
}

JsonValue as_json(const std::optional<ContainedWords>& contained) {
  if (!contained) return {};
  const ContainmentProof& proof = contained->proof;
  JsonValue::Array centres;
  for (const std::string& name : proof.centres_outside) centres.push_back(name);
  return JsonObject{{"asked", option_of(contained->containment)},       {"proven", proof.proven},
                    {"triangles_proven", proof.triangles_proven},       {"triangles_refuted", proof.triangles_refuted},
                    {"triangles_undecided", proof.triangles_undecided}, {"centres_outside", centres},
                    {"maybe_with_cavities", proof.maybe_with_cavities}, {"proofs", contained->proofs}};
}

JsonValue as_json(const DistanceStatistics& proven) {
  return JsonObject{{"largest", proven.largest},
                    {"mean", proven.mean},
                    {"percentile_95", proven.percentiles.empty() ? JsonValue() : JsonValue(proven.percentiles[0])}};
}

JsonValue as_json(const std::optional<Deviation>& proven) {
  if (!proven || !proven->from_mesh || !proven->from_model) return {};
  return JsonObject{{"mesh_to_model", as_json(*proven->from_mesh)},
                    {"model_to_mesh", as_json(*proven->from_model)},
                    {"hausdorff", proven->hausdorff},
                    {"to_tolerance", proven->to_tolerance}};
}

JsonValue as_json(const EstimatedDeviation& deviation) {
  return JsonObject{{"mean", deviation.mean},
                    {"root_mean_square", deviation.root_mean_square},
                    {"percentile_95", deviation.percentile_95},
                    {"largest", deviation.largest}};
}

std::string option_of(Containment containment) {
  return containment == Containment::within ? "inside" : "outside";
}

/// Why it is not proven. Precondition: it is not.
std::string obstacle(const ContainedWords& contained) {
  const ContainmentProof& proof = contained.proof;
  const std::string option = "--" + option_of(contained.containment);
  if (proof.triangles_refuted + proof.triangles_undecided > 0)
    return fmt::format("{}: is not proven; {} triangles are proven to be on the wrong side, {} are undecided", option,
                       proof.triangles_refuted, proof.triangles_undecided);
  if (!proof.centres_outside.empty())
    return fmt::format("{}: is not proven; {} is not proven to lie within the mesh", option,
                       quotation(proof.centres_outside[0]));
  return fmt::format("{}: is not proven; the union of the primitives may have cavities", option);
}

bool RecoverReport::reached() const {
  if (!deviation) return true;
  const RecoveryStage& last = recovery.stages.back();
  return last.to_model.percentile_95 <= *deviation && (!last.to_mesh || last.to_mesh->percentile_95 <= *deviation);
}

std::string readable(const RecoverReport& report) {
  const Recovery& recovery = report.recovery;
  const std::string units = units_behind(recovery.model.units);
  std::string text = table(report);
  text += fmt::format("deviations above   estimated from samples{}, not proven\n",
                      units.empty() ? "" : fmt::format(", in{}", units));
  if (report.contained) text += contained_line(*report.contained);
  if (report.proven) text += proven_lines(*report.proven, units);
  text += fmt::format("points             {}{}\n", recovery.points, report.of_mesh ? " sampled on the mesh" : "");
  if (!report.of_mesh) text += fmt::format("outliers           {:.3g} %, estimated\n", 100.0 * recovery.outliers);
  text += fmt::format("time               {:.3g} s\n", report.seconds);
  text += fmt::format("model              {} {}: {}\n", recovery.model.primitives.size(),
                      recovery.model.primitives.size() == 1 ? "primitive" : "primitives", quotation(report.output));
  if (!report.files.html.empty()) text += fmt::format("report             {}\n", quotation(report.files.html));
  if (!report.files.png.empty()) text += fmt::format("picture            {}\n", quotation(report.files.png));
  if (!report.certificate.empty()) text += fmt::format("certificate        {}\n", quotation(report.certificate));
  return text;
}

/// One line.
std::string json(const RecoverReport& report) {
  const Recovery& recovery = report.recovery;
  JsonValue::Array stages;
  for (const RecoveryStage& stage : recovery.stages) {
    stages.push_back(
        JsonObject{{"primitives", stage.primitives},
                   {"estimated_to_model", as_json(stage.to_model)},
                   {"estimated_to_mesh", stage.to_mesh ? as_json(*stage.to_mesh) : JsonValue()},
                   {"containment", stage.containment ? JsonValue(option_of(*stage.containment)) : JsonValue()}});
  }
  JsonObject object{
      {"primitives", recovery.model.primitives.size()},
      {"stages", stages},
      {"proven", as_json(report.proven)},
      {"containment", as_json(report.contained)},
      {"points", recovery.points},
      {"estimated_outliers", recovery.outliers},
      {"deviation_asked", report.deviation},
      {"deviation_reached", report.reached()},
      {"units", recovery.model.units},
      {"seconds", report.seconds},
      {"interrupted", recovery.interrupted},
      {"output", report.output},
      {"report", report.files.html},
      {"png", report.files.png},
  };
  if (!report.certificate.empty()) object.set("certificate", report.certificate);
  return object.text() + "\n";
}

constexpr std::size_t most_primitives = 64;
constexpr std::size_t most_for_deviation = 24;  // where --deviation alone says when to stop

constexpr const char* closing_words =
    R"(One primitive is the likeliest superquadric for the points: some may be missing, moved by noise, or outliers that
belong to nothing. Several are a union, grown one by one; of a closed mesh they also fill its inside, and primitives
that the union does as well without are left out at the end.

Deviations on the way are estimated from samples, in floating point; that of the result from a mesh is proven, as
`verisq deviation` does it. The same seed gives the same model.

--inside and --outside begin with the same search. Then the union is fitted with the mesh's surface on one side of
it, and grows or shrinks until that is proven, of all points of all triangles.

--certificate-file keeps what proves that once more.

Ctrl-C and --time-limit end the search: the best model so far is written.

Exit status: 0 done; 3 written, but --deviation is not reached, --inside or --outside not proven, or the time limit
ended it; 2 bad usage or input; 130 interrupted by Ctrl-C.

Examples:
  verisq recover --points scan.csv -o part.json
  verisq recover --mesh stem.stl --primitives 8 --taper --deviation 0.1 --units mm -o stem.json
  verisq recover --mesh femur.stl --primitives 6 --report femur.html -o femur.json
  verisq recover --mesh femur.stl --primitives 6 --outside -o hull.json)";

std::optional<Containment> containment_of(const RecoverArguments& arguments) {
  if (arguments.inside) return Containment::within;
  if (arguments.outside) return Containment::around;
  return std::nullopt;
}

std::size_t most_of(const RecoverArguments& arguments) {
  return arguments.primitives.value_or(arguments.deviation ? most_for_deviation : 1);
}

RecoveryOptions options_of(const RecoverArguments& arguments, const Deadline& limit) {
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
  options.interrupted = limit.stop();
  return options;
}

/// Checks everything that the options alone determine, before any file is opened.
void check_usage(const RecoverArguments& arguments) {
  const std::vector<std::string> inputs{arguments.points, arguments.mesh};
  refuse_to_overwrite("-o", arguments.output, inputs);
  if (!arguments.certificate_file.empty()) {
    if (!containment_of(arguments)) refuse("--certificate-file: only with --inside or --outside");
    if (arguments.outside && arguments.bend) refuse("--certificate-file: --outside is not certified with --bend");
    check_certificate_file(arguments.certificate_file, inputs);
  }
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
      recover_contained(input, *containment, options, {.device = arguments.device, .interrupted = options.interrupted});
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

/// A certificate needs a mesh that has sides: this is checked before all the work.
void refuse_mesh_without_sides(const RecoverArguments& arguments, const Mesh& mesh) {
  if (arguments.certificate_file.empty()) return;
  try {
    check_surface_has_sides(mesh);
  } catch (const Error& error) {
    refuse(fmt::format("--certificate-file: {}: {}", arguments.mesh, error.what()));
  }
}

/// Writes the certificate of a proven containment, if it is asked for and proves that again. Returns the name of the
/// file; "" where nothing is to be written; nothing where it proves less.
std::optional<std::string> write_certificate(const RecoverArguments& arguments, const Found& found, const Mesh& mesh,
                                             const Deadline& limit) {
  if (arguments.certificate_file.empty() || !found.contained || !found.contained->proof.proven) return "";
  const ContainmentCertificate& certificate = found.contained->proof.certificate;
  const ContainmentFinding checked = ContainmentChecker(found.recovery.model, mesh)(
      found.contained->containment, certificate,
      {.in_parallel = in_parallel<std::function<void(std::size_t)>>, .interrupted = limit.stop()});
  if (checked.verdict != Verdict::proved) {
    tell(fmt::format("--certificate-file: is not written; not proven again: {}", checked.open));
    return std::nullopt;
  }
  write_answer(arguments.certificate_file,
               ContainmentAnswer{subject_file(arguments.output), subject_file(arguments.mesh), arguments.units,
                                 found.contained->containment, certificate});
  return arguments.certificate_file;
}

/// The mesh, coloured by how far it is from the model; false where that is not known of all vertices.
bool write_report(const RecoverArguments& arguments, const Model& model, const Mesh& mesh, const Deviation& proven) {
  if (!arguments.report.any()) return false;
  if (proven.map.interrupted) {
    tell(fmt::format("{}; report and picture are not written", reason_of_end()));
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
  if (report.recovery.interrupted || (report.proven && report.proven->interrupted)) return status_of_end();
  return report.reached() && report.is_contained() ? ExitStatus::verified : ExitStatus::unverified;
}

double parse_share(std::string_view option, const std::string& text) {
  const std::optional<double> share = finite_number(text);
  if (!share || *share < 0.0 || *share > 0.9) refuse(fmt::format("{}: {} is not from 0 to 0.9", option, text));
  return *share;
}

void declare_recover(Options& options, RecoverArguments& arguments) {
  options.explain(closing_words);
  options.add("--points", arguments.points, "FILE",
              "Point cloud: text with x,y,z a line, .npy, or a mesh (.stl, .obj, .ply, .off, .vtp, .vtk), whose "
              "vertices count");
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
  options.add("--certificate-file", arguments.certificate_file, "FILE",
              "With --inside or --outside: what proves it again, for `verisq check --certificate`: .json");
  declare_report_files(options, arguments.report);
  add_device(options, arguments.device);
  add_time_limit(options, arguments.time_limit, "the best model by then is written");
  add_json_of_enclosures(options, arguments.json);
  add_no_progress(options, arguments.no_progress);
}

/// Throws Error(input) for whatever the user can correct.
ExitStatus run_recover(const RecoverArguments& arguments) {
  Deadline limit(arguments.time_limit, interrupted);
  const RecoveryOptions options = options_of(arguments, limit);
  check_usage(arguments);
  const OutputFile trial(arguments.output);  // known before all the work; leaves nothing behind
  const Stopwatch time;
  const Mesh input = read_input(arguments);
  refuse_mesh_without_sides(arguments, input);
  watch_for_interruption();
  limit.start();
  Found found = search(input, arguments, options);
  Recovery& recovery = found.recovery;
  recovery.model.units = arguments.units;
  write_model(arguments.output, recovery.model);
  if (recovery.interrupted)
    tell(fmt::format("{}; the best model so far is kept in {}", reason_of_end(), arguments.output));
  const std::optional<std::string> certificate = write_certificate(arguments, found, input, limit);
  std::optional<Deviation> proven;
  if (!recovery.interrupted && !input.triangles.empty() && !arguments.no_proof) {
    // For bent solids the mean takes very long.
    proven = proven_deviation(recovery.model, input,
                              {.device = arguments.device,
                               .no_progress = arguments.no_progress,
                               .statistics = is_union_of_convex(recovery.model),
                               .ended = limit.stop()});
    if (proven->interrupted)
      tell(fmt::format("{}; the model is in {}, its deviation is wide", reason_of_end(), arguments.output));
  }
  const bool is_drawn = proven && write_report(arguments, recovery.model, input, *proven);
  const RecoverReport report{.recovery = recovery,
                             .of_mesh = !arguments.mesh.empty(),
                             .deviation = arguments.deviation,
                             .contained = found.contained,
                             .proven = proven,
                             .output = arguments.output,
                             .files = is_drawn ? arguments.report : ReportFiles(),
                             .certificate = certificate.value_or(""),
                             .seconds = time.seconds()};
  if (!recovery.interrupted && !report.reached())
    tell(fmt::format("--deviation {:.6g}: is not reached", *arguments.deviation));
  if (!recovery.interrupted && !report.is_contained()) tell(obstacle(*found.contained));
  fmt::print("{}", arguments.json ? json(report) : readable(report));
  const ExitStatus status = status_of(report);
  return status == ExitStatus::verified && !certificate ? ExitStatus::unverified : status;
}

}  // namespace

Command recover_command() {
  return command("recover", "Make a model of a point cloud or a mesh, without proof", declare_recover, run_recover);
}

}  // namespace verisq::command_line
