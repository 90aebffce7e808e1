/// Reads the options and files of `verisq map`, runs the map, reports.
#include "host/command_line/map_command.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <system_error>
#include <verisq/distance_map.hpp>
#include <verisq/error.hpp>
#include <verisq/map_file.hpp>
#include <verisq/model_file.hpp>
#include <verisq/signed_distance.hpp>

#include "host/command_line/interruption.hpp"
#include "host/command_line/map_summary.hpp"
#include "host/command_line/progress_bar.hpp"

namespace verisq::command_line {
namespace {

constexpr double default_relative_tolerance = 1e-6;  // of the radius of the model's bounding sphere

constexpr const char* closing_words =
    "Each row of the map is [lo, hi], which contains the exact signed distance from the point to the model: positive\n"
    "outside, negative inside. \"Verified\" rows are at most the tolerance wide; \"wide\" ones are valid all the "
    "same.\n"
    "Ctrl-C keeps the finished rows of a .csv under OUT.partial; a second Ctrl-C stops at once.\n"
    "\n"
    "Examples:\n"
    "  verisq map --model stem.json --mesh femur.off -o clearance.vtp\n"
    "  verisq map --model stem.json --points samples.csv --tol 1e-9 --device host -o distances.csv --json";

[[noreturn]] void refuse(const std::string& message) {
  throw Error(ErrorKind::input, message);
}

double parse_tolerance(const std::string& text) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  const bool is_number = error == std::errc() && rest == end;
  if (!is_number || !std::isfinite(value) || value < 0.0) {
    refuse(fmt::format("--tol: {} is not a finite number of at least 0", text));
  }
  return value;
}

double default_tolerance(const Model& model) {
  const double tolerance = default_relative_tolerance * bounding_radius(model);
  // An infinite tolerance would call every enclosure verified.
  if (!std::isfinite(tolerance)) refuse("--tol: give one, because the size of the model overflows");
  return tolerance;
}

/// Everything that the options alone tell, before any file is opened.
void check_usage(const MapArguments& arguments) {
  check_usage(arguments.inputs);
  if (arguments.on == "triangles") refuse("--on triangles: not supported yet, only vertices");
  if (arguments.on != "vertices") refuse(fmt::format("--on: {} is not one of vertices, triangles", arguments.on));
  for (const auto& input : {arguments.inputs.model, arguments.inputs.mesh, arguments.inputs.points}) {
    std::error_code missing;  // a file that does not exist is not overwritten
    if (!input.empty() && std::filesystem::equivalent(input, arguments.output, missing)) {
      refuse(fmt::format("-o {}: would overwrite an input of the map", arguments.output));
    }
  }
}

using Clock = std::chrono::steady_clock;

double seconds_between(Clock::time_point start, Clock::time_point end) {
  return std::chrono::duration<double>(end - start).count();
}

struct MappedStream {
  MapSummary summary;
  Clock::time_point first_point;  ///< when the first point was asked for: the device is ready then
};

MappedStream map_stream(const Model& model, PointStream& stream, MapWriter& writer, const MapOptions& options,
                        bool show_progress) {
  std::optional<ProgressBar> bar;  // begins at the first point: compiling kernels is no part of the rate
  auto first_point = Clock::now();
  const auto source = [&](std::span<Point> points) {
    if (!bar) {
      first_point = Clock::now();
      bar.emplace(show_progress);
    }
    return stream.read(points);
  };
  std::uint64_t done = 0;
  const auto sink = [&](std::span<const Point> points, std::span<const MapResult> results,
                        std::span<const Certificate> certificates) {
    writer.append(points, results, certificates);
    done += points.size();
    bar->update(done, stream.fraction(done));
  };
  return {map_points(model, source, sink, options), first_point};
}

/// Returns the name of the file that holds the map; empty when an interrupted map left none.
std::string end_map(MapWriter& writer, const MapSummary& summary, const std::string& output) {
  if (!summary.interrupted) {
    writer.finish();
    return output;
  }
  const auto partial = writer.keep_partial().string();
  if (partial.empty()) {
    fmt::print(stderr, "verisq: interrupted; {} is not written, because only .csv can hold a part of a map\n", output);
  } else {
    fmt::print(stderr, "verisq: interrupted; the first {} rows are kept in {}\n", summary.points, partial);
  }
  return partial;
}

ExitStatus status_of(const MapSummary& summary) {
  if (summary.interrupted) return ExitStatus::interrupted;
  return summary.wide > 0 ? ExitStatus::unverified : ExitStatus::verified;
}

}  // namespace

const CLI::App& declare_map(CLI::App& program, MapArguments& arguments) {
  CLI::App& map = *program.add_subcommand("map", "Enclose the signed distance of each vertex or point to a model");
  map.footer(closing_words);
  declare_inputs(map, arguments.inputs);
  map.add_option("--on", arguments.on, "What of the mesh is mapped: vertices (triangles: not supported yet)")
      ->option_text("WHAT");
  map.add_option("--tol", arguments.tolerance,
                 "Largest width of a verified enclosure, in model units; 0 asks for the tightest.\n"
                 "Default: 1e-6 times the radius of the model's bounding sphere")
      ->option_text("NUMBER");
  map.add_option("--device", arguments.device,
                 "auto (default), host (no OpenCL), or an index or part of a name from `verisq devices`")
      ->option_text("DEVICE");
  map.add_option("-o,--output", arguments.output, "The map, by extension: .csv .vtp .ply .json")
      ->required()
      ->option_text("FILE REQUIRED");
  map.add_flag("--certificates", arguments.certificates,
               "Write what proves each enclosure again, for `verisq check`: .csv .vtp");
  map.add_flag("--json", arguments.json, "Print the summary as one JSON object");
  map.add_flag("--no-progress", arguments.no_progress, "No progress bar, even on a terminal");
  return map;
}

ExitStatus run_map(const MapArguments& arguments) {
  check_usage(arguments);
  std::optional<double> tolerance;
  if (arguments.tolerance) tolerance = parse_tolerance(*arguments.tolerance);

  const Model model = read_model(arguments.inputs.model);
  PointStream stream(arguments.inputs);
  const MapOptions options{.tolerance = tolerance ? *tolerance : default_tolerance(model),
                           .device = arguments.device,
                           .certificates = arguments.certificates,
                           .interrupted = interrupted};

  watch_for_interruption();
  MapWriter writer(arguments.output, stream.mesh(),
                   arguments.certificates ? MapContents::certified : MapContents::enclosures);
  const auto start = Clock::now();
  const auto [summary, first_point] = map_stream(model, stream, writer, options, !arguments.no_progress);
  const auto written = end_map(writer, summary, arguments.output);
  const auto end = Clock::now();

  if (!summary.notice.empty()) fmt::print(stderr, "verisq: {}\n", summary.notice);
  const MapReport report{.summary = summary,
                         .output = written,
                         .units = model.units,
                         .tolerance = options.tolerance,
                         .preparation_seconds = seconds_between(start, first_point),
                         .seconds = seconds_between(first_point, end)};
  fmt::print("{}", arguments.json ? json(report) : readable(report));
  return status_of(summary);
}

}  // namespace verisq::command_line
