/// This file implements deviation_command.hpp.
#include "host/command_line/deviation_command.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>
#include <verisq/certificate_file.hpp>
#include <verisq/deviation.hpp>
#include <verisq/error.hpp>
#include <verisq/features.hpp>
#include <verisq/files.hpp>
#include <verisq/map_file.hpp>

#include "host/command_line/inputs.hpp"
#include "host/command_line/options.hpp"
#include "host/command_line/outputs.hpp"
#include "host/command_line/run.hpp"
#include "host/command_line/shared_inputs.hpp"
#include "host/command_line/summaries.hpp"
#include "host/errors/refusal.hpp"
#include "host/files/map_layout.hpp"
#include "host/prepare/femur_axes.hpp"

namespace verisq::command_line {

Deviation proven_deviation(const Model& model, const Mesh& mesh, const ProofArguments& arguments) {
  ProgressBar bar(!arguments.no_progress, "points");
  DeviationOptions options;
  options.percentiles = proven_percentiles;
  options.statistics_of_surface = arguments.statistics;
  options.device = arguments.device;
  options.interrupted = arguments.ended;
  options.progress = [&bar](std::string_view stage, double done) { bar.update_state(stage, done); };
  return deviation(model, mesh, options);
}

namespace {

constexpr int digits = 5;
constexpr const char* what_is_proven = "the model's boundary and the triangles as their binary64 corners state them";
constexpr const char* what_is_proven_of_points =
    "the model's boundary and the points as their binary64 numbers state them";

std::string with_units(const Enclosure& enclosure, const DeviationReport& report) {
  return outward_digits(enclosure, digits) + units_behind(report.units);
}

struct Line {
  std::string label;
  std::string value;
};

void add_statistics(std::vector<Line>& lines, const std::string& direction, const DistanceStatistics& statistics,
                    const DeviationReport& report) {
  lines.push_back({direction, ""});
  lines.push_back({"  largest", with_units(statistics.largest, report)});
  if (statistics.mean) lines.push_back({"  mean", with_units(*statistics.mean, report)});
  for (std::size_t i = 0; i < statistics.percentiles.size(); ++i) {
    lines.push_back(
        {fmt::format("  {:g} %", report.options.percentiles[i]), with_units(statistics.percentiles[i], report)});
  }
}

/// Means are as narrow as the means of all regions together required.
void add_regions(std::vector<Line>& lines, const DeviationReport& report) {
  if (report.region_names.empty()) return;
  lines.push_back({"mesh to model by region", ""});
  for (std::size_t i = 0; i < report.region_names.size(); ++i) {
    const DistanceStatistics& region = report.deviation.by_region[i];
    const bool is_empty = std::ranges::find(report.options.region_of, i) == report.options.region_of.end();
    const std::string name = quotation(report.region_names[i]);
    lines.push_back({"  region", is_empty ? "no triangles: " + name
                                          : fmt::format("largest {}, mean {}: {}", with_units(region.largest, report),
                                                        with_units(*region.mean, report), name)});
  }
}

JsonValue json_of_regions(const DeviationReport& report) {
  JsonValue::Array regions;
  for (std::size_t i = 0; i < report.region_names.size(); ++i) {
    const DistanceStatistics& region = report.deviation.by_region[i];
    const auto triangles = std::ranges::count(report.options.region_of, i);
    regions.push_back(JsonObject{{"name", report.region_names[i]},
                                 {"triangles", static_cast<std::size_t>(triangles)},
                                 {"largest", region.largest},
                                 {"farthest", region.farthest},
                                 {"mean", region.mean}});
  }
  return {regions};
}

std::string tolerance_text(const DeviationReport& report) {
  if (!report.options.tolerance) return fmt::format("{:g} %", 100.0 * report.options.relative_tolerance);
  return fmt::format("{:g}{}", *report.options.tolerance, units_behind(report.units));
}

/// The summary of the mesh, or of the points.
const DistanceSummary& certified_summary(const ProvenDeviation& proven) {
  return proven.from_mesh ? *proven.from_mesh : proven.of_vertices;
}

/// The most important first: a picture has room for a few lines.
std::vector<Line> lines_of(const DeviationReport& report) {
  const Deviation& deviation = report.deviation;
  std::vector<Line> lines;
  if (deviation.hausdorff) lines.push_back({"both ways (Hausdorff)", with_units(*deviation.hausdorff, report)});
  if (deviation.from_mesh) add_statistics(lines, "mesh to model", *deviation.from_mesh, report);
  add_regions(lines, report);
  if (deviation.from_model) {
    add_statistics(lines, report.is_cloud ? "model to points" : "model to mesh", *deviation.from_model, report);
  }
  add_statistics(lines, report.is_cloud ? "points to model" : "vertices to model", deviation.of_vertices, report);
  if (!deviation.from_model) lines.push_back({"model to points", "not asked for: --both-ways"});
  lines.push_back({"proven of", report.is_cloud ? what_is_proven_of_points : what_is_proven});
  lines.push_back(
      {"tolerance", tolerance_text(report) + (deviation.to_tolerance ? ", reached" : ", not reached by all")});
  return lines;
}

JsonValue json_of(const std::optional<DistanceStatistics>& statistics, const DeviationReport& report) {
  if (!statistics) return {};
  JsonValue::Array percentiles;
  for (std::size_t i = 0; i < statistics->percentiles.size(); ++i) {
    const Enclosure& value = statistics->percentiles[i];
    percentiles.push_back(JsonObject{{"percent", report.options.percentiles[i]}, {"lo", value.lo}, {"hi", value.hi}});
  }
  JsonObject object{{"largest", statistics->largest}, {"farthest", statistics->farthest}};
  if (statistics->mean) object.set("mean", *statistics->mean);
  if (!percentiles.empty()) object.set("percentiles", percentiles);
  return object;
}

JsonValue::Array json_of_percentiles(const std::vector<Enclosure>& values, const DeviationReport& report) {
  JsonValue::Array percentiles;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto& [lo, hi] = values[i];
    percentiles.push_back(JsonObject{{"percent", report.options.percentiles[i]}, {"lo", lo}, {"hi", hi}});
  }
  return percentiles;
}

JsonValue json_of_certified(const DeviationReport& report) {
  if (!report.certified) return {};
  const DistanceSummary& summary = certified_summary(*report.certified);
  JsonObject object{{"largest", summary.largest},
                    {"mean", summary.mean},
                    {"percentiles", json_of_percentiles(summary.percentiles, report)},
                    {report.is_cloud ? "model_to_points" : "model_to_mesh", report.certified->from_model},
                    {"hausdorff", report.certified->hausdorff}};
  if (const auto& statistics = report.certified->statistics_from_model) {
    object.set("model_mean", statistics->mean);
    object.set("model_percentiles", json_of_percentiles(statistics->percentiles, report));
  }
  return object;
}

std::string certified_in_words(const DeviationReport& report) {
  const ProvenDeviation& certified = *report.certified;
  const auto line = [&](const std::string& label, const Enclosure& value) {
    return fmt::format("{:<23}{}\n", label, with_units(value, report));
  };
  const auto percentile_lines = [&](const char* label, const std::vector<Enclosure>& values) {
    std::string text;
    for (std::size_t i = 0; i < values.size(); ++i)
      text += line(fmt::format("  {}, {:g} %", label, report.options.percentiles[i]), values[i]);
    return text;
  };
  const DistanceSummary& summary = certified_summary(certified);
  std::string text = line("  proves, largest", summary.largest) + line("  proves, mean", summary.mean) +
                     percentile_lines("proves", summary.percentiles);
  if (!certified.from_model) return text;
  text += line(report.is_cloud ? "  model to points" : "  model to mesh", *certified.from_model);
  if (const auto& statistics = certified.statistics_from_model)
    text += line("  model, mean", statistics->mean) + percentile_lines("model", statistics->percentiles);
  return text + line("  both ways", *certified.hausdorff);
}

}  // namespace

std::string readable(const DeviationReport& report) {
  const Deviation& deviation = report.deviation;
  std::string text = fmt::format("{:<23}{}\n", report.is_cloud ? "points" : "vertices", deviation.vertices.size());
  if (!report.is_cloud) text += fmt::format("{:<23}{}\n", "triangles", report.triangles);
  for (const auto& [label, value] : lines_of(report)) {
    text += value.empty() ? label + "\n" : fmt::format("{:<23}{}\n", label, value);
  }
  text += fmt::format("{:<23}{}\n", "device", quotation(deviation.map.device));
  text += fmt::format("{:<23}{} distances to the model, {} patches of its surface\n", "evaluations",
                      deviation.vertices.size() + deviation.samples, deviation.patches);
  text += fmt::format("{:<23}{:.3g} s\n", "time", report.seconds);
  if (!report.output.empty()) text += fmt::format("{:<23}{}\n", "map", quotation(report.output));
  if (report.certified) {
    text += fmt::format("{:<23}{}\n", "certificate", quotation(report.certificate));
    text += certified_in_words(report);
  }
  if (!report.files.html.empty()) text += fmt::format("{:<23}{}\n", "report", quotation(report.files.html));
  if (!report.files.png.empty()) text += fmt::format("{:<23}{}\n", "picture", quotation(report.files.png));
  return text;
}

std::vector<ReportLine> report_lines(const DeviationReport& report) {
  std::vector<ReportLine> lines;
  std::string direction;
  for (const auto& [label, value] : lines_of(report)) {
    if (value.empty()) {
      direction = label + ",";
    } else if (label.starts_with("  ")) {
      lines.push_back({direction + label.substr(1), value});
    } else {
      lines.push_back({label, value});
    }
  }
  return lines;
}

std::string json(const DeviationReport& report) {
  const Deviation& deviation = report.deviation;
  const bool is_cloud = report.is_cloud;
  const std::optional<DistanceStatistics> vertices = deviation.of_vertices;
  const JsonObject object{
      {is_cloud ? "points" : "vertices", deviation.vertices.size()},
      {"triangles", report.triangles},
      {is_cloud ? "points_to_model" : "vertices_to_model", json_of(vertices, report)},
      {"mesh_to_model", json_of(deviation.from_mesh, report)},
      {is_cloud ? "model_to_points" : "model_to_mesh", json_of(deviation.from_model, report)},
      {"mesh_to_model_by_region", json_of_regions(report)},
      {"hausdorff", deviation.hausdorff},
      {"tolerance", report.options.tolerance},
      {"relative_tolerance", report.options.tolerance ? JsonValue() : JsonValue(report.options.relative_tolerance)},
      {"to_tolerance", deviation.to_tolerance},
      {"units", report.units},
      {"samples", deviation.vertices.size() + deviation.samples},
      {"patches", deviation.patches},
      {"device", deviation.map.device},
      {"notice", deviation.map.notice},
      {"seconds", report.seconds},
      {"interrupted", deviation.interrupted},
      {"out_of_time", deviation.out_of_time},
      {"output", report.output},
      {"certificate", report.certificate},
      {"certified", json_of_certified(report)},
      {"report", report.files.html},
      {"png", report.files.png},
  };
  return object.text() + "\n";
}

namespace {

std::string file_name(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

}  // namespace

void write(const ReportFiles& files, const DrawnDeviation& drawn, const DeviationReport& report) {
  write(files, {.title = fmt::format("{}: deviation from {}", file_name(drawn.mesh_file), file_name(drawn.model_file)),
                .bone = drawn.mesh,
                .rows = report.deviation.vertices,
                .implant = drawn.model,
                .units = drawn.model.units,
                .summary = report_lines(report),
                .area_names = {},
                .area_of = {},
                .solid_name = "model"});
}

namespace {

constexpr std::uint32_t most_parts = 100;

constexpr const char* closing_words =
    R"(Encloses the distance of each vertex to the model's surface; over all points of all triangles the largest, the
mean by area and percentiles of that distance; and over the whole surface of the model the largest distance to
the mesh. The larger of both largest ones is the two-sided Hausdorff distance.
Of --parts or --landmarks the table by region tells largest and mean of the triangles whose centroids lie there.
Proven is the distance between the boundary of the model's solid and the triangles exactly as their binary64
corners state them: neither what was measured nor what lies inside of the mesh. It need not be closed.
Of --points each point counts by itself, from the points to the model; with --both-ways also the model's surface
to the nearest point. The rows of -o, of the report and of the picture are signed, as those of `verisq map`.
At the --time-limit, and at Ctrl-C, everything printed is valid, and wide.

Exit status: 0 every enclosure is as narrow as --tol asks, 3 one is wider, 2 bad usage or input, 130 interrupted
by Ctrl-C, 143 by SIGTERM, 129 by SIGHUP.

Examples:
  verisq deviation --model stem.json --mesh stem.stl
  verisq deviation --model femur.json --mesh femur.stl --tol 0.05 --png deviation.png -o vertices.csv
  verisq deviation --model femur.json --mesh femur.stl --landmarks landmarks.json --statistics-of-model
  verisq deviation --model stem.json --points scan.csv --percentile 90 --percentile 99 --json)";

double parse_percentile(std::string_view option, const std::string& text) {
  const std::optional<double> percent = finite_number(text);
  if (!percent || !(*percent > 0.0 && *percent <= 100.0)) {
    refuse(fmt::format("{}: {} is no number above 0 and at most 100", option, text));
  }
  return *percent;
}

/// Checks everything that the options alone determine, before any file is opened.
void check_usage(const DeviationArguments& arguments) {
  check_usage(arguments.inputs);
  if (arguments.both_ways && arguments.inputs.points.empty()) {
    refuse("--both-ways: only for --points; of a --mesh both ways are measured");
  }
  if (arguments.statistics_of_model && !arguments.inputs.points.empty() && !arguments.both_ways) {
    refuse("--statistics-of-model: of --points only with --both-ways");
  }
  if (arguments.parts > 0 && !arguments.landmarks.empty()) refuse("--parts and --landmarks: give one of them");
  if ((arguments.parts > 0 || !arguments.landmarks.empty()) && arguments.inputs.mesh.empty()) {
    refuse(fmt::format("{}: only for a --mesh", arguments.parts > 0 ? "--parts" : "--landmarks"));
  }
  const std::vector<std::string> inputs{arguments.inputs.model, arguments.inputs.mesh, arguments.inputs.points};
  if (!arguments.output.empty()) refuse_to_overwrite("-o", arguments.output, inputs);
  if (!arguments.certificate_file.empty() && arguments.time_limit) refuse("--certificate-file: not with --time-limit");
  check_certificate_file(arguments.certificate_file, inputs);
  check_usage(arguments.report, inputs, {arguments.output, arguments.certificate_file});
  if (!arguments.report.any()) return;
  if (arguments.inputs.mesh.empty()) {
    refuse(fmt::format("{}: give a --mesh to draw", arguments.report.html.empty() ? "--png" : "--report"));
  }
}

Mesh read_input(const InputArguments& inputs) {
  if (inputs.mesh.empty()) return read_cloud(inputs.points);
  Mesh mesh = read_mesh(inputs.mesh);
  if (mesh.triangles.empty()) refuse(fmt::format("{}: has no triangles; give its points by --points", inputs.mesh));
  return mesh;
}

DeviationOptions options_of(const DeviationArguments& arguments, const Deadline& limit) {
  DeviationOptions options;
  if (arguments.tolerance && arguments.tolerance->is_share) options.relative_tolerance = arguments.tolerance->value;
  if (arguments.tolerance && !arguments.tolerance->is_share) options.tolerance = arguments.tolerance->value;
  if (!arguments.percentiles.empty()) options.percentiles = arguments.percentiles;
  options.statistics_of_model = arguments.statistics_of_model;
  options.from_model = arguments.inputs.points.empty() || arguments.both_ways;
  options.device = arguments.device;
  options.interrupted = interrupted;
  options.out_of_time = limit.out_of_time();
  return options;
}

/// None if none are requested.
features::Regions regions_of(const Mesh& mesh, const DeviationArguments& arguments) {
  if (arguments.parts > 0) return features::parts_along(mesh, arguments.parts);
  if (arguments.landmarks.empty()) return {};
  try {
    return features::femur_regions(mesh, read_landmarks(arguments.landmarks).landmarks);
  } catch (const Error& error) {
    const std::string what = error.what();
    if (what.starts_with(arguments.landmarks)) throw;
    throw Error(error.kind(), fmt::format("{}: {}", arguments.landmarks, what));
  }
}

/// Returns the name of the file of the rows; empty if none was requested, or if an interrupted map left none.
std::string write_rows(const Mesh& mesh, const Deviation& deviation, std::optional<MapWriter>& writer,
                       const std::string& output) {
  if (!writer) return {};
  const std::size_t rows = deviation.map.points;
  writer->append(std::span(mesh.vertices).first(rows), std::span(deviation.vertices).first(rows));
  if (!deviation.map.interrupted) {
    writer->finish();
    return output;
  }
  const std::string partial = writer->keep_partial().string();
  tell(partial.empty() ? fmt::format("interrupted; {} is not written", output)
                       : fmt::format("interrupted; the first {} rows are kept in {}", rows, partial));
  return partial;
}

/// False where the vertices are not all known.
bool write_report(const Model& model, const Mesh& mesh, const DeviationReport& report,
                  const DeviationArguments& arguments) {
  if (!arguments.report.any()) return true;
  if (report.deviation.map.interrupted) {
    tell("interrupted; report and picture are not written");
    return false;
  }
  write(arguments.report, {model, arguments.inputs.model, mesh, arguments.inputs.mesh}, report);
  return true;
}

/// False where it is interrupted.
bool write_certificate(const Model& model, const Mesh& mesh, const DeviationArguments& arguments,
                       DeviationReport& report) {
  const std::string& file = arguments.certificate_file;
  if (file.empty() || report.deviation.interrupted) return file.empty();
  ProgressBar bar(!arguments.no_progress, "points");
  DeviationOptions options = report.options;
  options.progress = [&bar](std::string_view stage, double done) { bar.update_state(stage, done); };
  CertifiedDeviation certified = certified_deviation(model, mesh, report.deviation, options);
  if (certified.proven.interrupted) return false;
  const InputArguments& inputs = arguments.inputs;
  write_answer(file, DeviationAnswer{.model = subject_file(inputs.model),
                                     .mesh = subject_file(inputs.mesh.empty() ? inputs.points : inputs.mesh),
                                     .units = model.units,
                                     .pose = inputs.pose,
                                     .percentiles = options.percentiles,
                                     .of_vertices = certified.proven.of_vertices,
                                     .from_mesh = certified.proven.from_mesh,
                                     .from_model = certified.proven.from_model,
                                     .statistics_from_model = certified.proven.statistics_from_model,
                                     .hausdorff = certified.proven.hausdorff,
                                     .certificate = std::move(certified.certificate)});
  report.certificate = file;
  report.without_surface = std::move(certified.without_surface);
  report.certified = std::move(certified.proven);
  return true;
}

/// Refuses a mesh whose certificates no file has room for, however short they are.
void refuse_too_many_vertices(const Mesh& mesh, const DeviationArguments& arguments) {
  constexpr std::size_t fewest_bytes = 128;  // of one: two ends and a vector
  const std::size_t most = largest_certificate / fewest_bytes;
  if (arguments.certificate_file.empty() || mesh.vertices.size() <= most) return;
  refuse(fmt::format("--certificate-file: {} vertices: no more than {} have room in one", mesh.vertices.size(), most));
}

ExitStatus status_of(const Deviation& deviation) {
  if (deviation.interrupted) return ExitStatus::interrupted;
  return deviation.to_tolerance ? ExitStatus::verified : ExitStatus::unverified;
}

/// "0.1", or "5%" for a share. Throws Error(input) that begins with `option` unless it is finite and above 0.
LengthOrShare parse_length_or_share(std::string_view option, const std::string& text) {
  const bool is_share = text.ends_with('%');
  const std::optional<double> number =
      finite_number(std::string_view(text).substr(0, text.size() - (is_share ? 1 : 0)));
  if (!number || !(*number > 0.0)) {
    refuse(fmt::format("{}: {} is no finite length above 0, and no such percentage", option, text));
  }
  return {is_share ? *number / 100.0 : *number, is_share};
}

void declare_deviation(Options& options, DeviationArguments& arguments) {
  options.explain(closing_words);
  declare_inputs(options, arguments.inputs);
  options.add("--tol", arguments.tolerance, parse_length_or_share, "NUMBER",
              "How wide an enclosure of the summary may be: with % of its upper end, else in model units. Of a share\n"
              "never less than 1e-6 times the radius of the model's bounding sphere. Default: 5%");
  options.add_each("--percentile", arguments.percentiles, parse_percentile, "P",
                   "Of the distances, above 0 and at most 100; may be given again and again (default: 50 and 95)");
  options.add_flag("--both-ways", arguments.both_ways, "Of --points, too, the model's surface to the nearest point");
  options.add_flag("--statistics-of-model", arguments.statistics_of_model,
                   "Mean and percentiles of the model's surface, too; takes several times as long");
  options.add("--parts", arguments.parts, whole_number<std::uint32_t>(1, most_parts), "N",
              "Where the mesh deviates: by N equal parts along its longest axis, 1 to 100");
  options.add("--landmarks", arguments.landmarks, "FILE",
              "Where a femur deviates: by head, neck, trochanters, shaft and condyles, of the landmarks that\n"
              "`verisq features -o` writes (verisq-landmarks/1)");
  options.add("--time-limit", arguments.time_limit, parse_time_limit, "SECONDS",
              "Ends the work this long after its beginning, with what is proven by then (default: none)");
  add_device(options, arguments.device);
  options.add("-o,--output", arguments.output, "FILE",
              fmt::format("{}: signed distances of the vertices or points", map_explanation));
  options.add("--certificate-file", arguments.certificate_file, "FILE",
              "What is found, of the regions nothing, with what proves it again, for `verisq check --certificate`:\n"
              ".json, up to 64 MiB");
  declare_report_files(options, arguments.report);
  add_json_of_enclosures(options, arguments.json);
  add_no_progress(options, arguments.no_progress);
}

/// Throws Error(input) for errors that the user can correct, before the first distance is computed.
ExitStatus run_deviation(const DeviationArguments& arguments) {
  check_usage(arguments);
  const Model model = read_model_at(arguments.inputs.pose, arguments.inputs.model);
  const Mesh mesh = read_input(arguments.inputs);
  tell_of_other_size(model, arguments.inputs.model, mesh.vertices,
                     arguments.inputs.mesh.empty() ? arguments.inputs.points : arguments.inputs.mesh);
  refuse_too_many_vertices(mesh, arguments);
  features::Regions regions = regions_of(mesh, arguments);
  watch_for_interruption();
  std::optional<MapWriter> writer;
  if (!arguments.output.empty()) writer.emplace(arguments.output, &mesh);

  Deadline limit(arguments.time_limit, interrupted);
  limit.start();
  const Stopwatch time;
  std::optional<ProgressBar> bar(std::in_place, !arguments.no_progress, "points");
  DeviationOptions options = options_of(arguments, limit);
  options.progress = [&bar](std::string_view stage, double done) { bar->update_state(stage, done); };
  options.region_of = std::move(regions.of_triangles);
  options.regions = static_cast<std::uint32_t>(regions.names.size());
  DeviationReport report{.deviation = deviation(model, mesh, options)};
  bar.reset();  // the line is cleared before anything else is said

  report.options = options;
  report.region_names = std::move(regions.names);
  report.units = model.units;
  report.is_cloud = mesh.triangles.empty();
  report.triangles = mesh.triangles.size();
  report.seconds = time.seconds();
  report.output = write_rows(mesh, report.deviation, writer, arguments.output);
  if (write_report(model, mesh, report, arguments)) report.files = arguments.report;
  bool certified = true;
  std::optional<Error> unwritten;  // thrown when all else is told
  try {
    certified = write_certificate(model, mesh, arguments, report);
  } catch (const Error& error) {
    unwritten = error;
  }
  if (!certified) tell(fmt::format("interrupted; {} is not written", arguments.certificate_file));
  if (!report.without_surface.empty()) {
    tell(fmt::format("{}: says nothing of how far the model's surface lies from the {}: {}", arguments.certificate_file,
                     report.is_cloud ? "points" : "mesh", report.without_surface));
  }
  tell_notice(report.deviation.map.notice);
  if (report.deviation.out_of_time) tell("the limit is reached; enclosures are valid, and some are wide");
  fmt::print("{}", arguments.json ? json(report) : readable(report));
  if (unwritten) throw Error(unwritten->kind(), unwritten->what());
  return certified ? status_of(report.deviation) : ExitStatus::interrupted;
}

}  // namespace

Command deviation_command() {
  return command("deviation", "Enclose how far a mesh and a model's surface lie apart, both ways", declare_deviation,
                 run_deviation);
}

}  // namespace verisq::command_line
