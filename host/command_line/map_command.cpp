/// Reads the options and files of `verisq map`, runs the map, reports.
#include "host/command_line/map_command.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>
#include <verisq/error.hpp>
#include <verisq/map_file.hpp>
#include <verisq/model_file.hpp>
#include <verisq/signed_distance.hpp>
#include <verisq/uncertain_map.hpp>

#include "host/command_line/interruption.hpp"
#include "host/command_line/length_option.hpp"
#include "host/command_line/map_summary.hpp"
#include "host/command_line/progress_bar.hpp"
#include "host/command_line/triangle_stream.hpp"

namespace verisq::command_line {
namespace {

constexpr double default_relative_tolerance = 1e-6;  // of the radius of the model's bounding sphere

constexpr const char* closing_words =
    "Each row of the map is [lo, hi], which contains the exact signed distance from the point to the model: positive\n"
    "outside, negative inside; or the distance from the whole triangle, 0 where it meets the model. \"Verified\"\n"
    "rows are at most the tolerance wide; \"wide\" ones are valid all the same.\n"
    "Where the model gives intervals [lo, hi] for semi-axes, exponents or translations, or points have a radius, each\n"
    "row contains the distances of all that they allow: give a --tol above that uncertainty to call rows verified.\n"
    "Ctrl-C keeps the finished rows of a .csv under OUT.partial; a second Ctrl-C stops at once.\n"
    "\n"
    "Examples:\n"
    "  verisq map --model stem.json --mesh femur.off -o clearance.vtp\n"
    "  verisq map --model stem.json --mesh femur.off --on triangles -o clearance.vtp\n"
    "  verisq map --model stem.json --points samples.csv --tol 1e-9 --device host -o distances.csv --json";

[[noreturn]] void refuse(const std::string& message) {
  throw Error(ErrorKind::input, message);
}

double default_tolerance(const UncertainModel& model) {
  const double tolerance = default_relative_tolerance * bounding_radius(bracket(model).largest);
  // An infinite tolerance would call every enclosure verified.
  if (!std::isfinite(tolerance)) refuse("--tol: give one, because the size of the model overflows");
  return tolerance;
}

MapElements parse_elements(const MapArguments& arguments) {
  if (arguments.on == "vertices") return MapElements::vertices;
  if (arguments.on != "triangles") refuse(fmt::format("--on: {} is not one of vertices, triangles", arguments.on));
  if (arguments.inputs.mesh.empty()) refuse("--on triangles: give their --mesh");
  return MapElements::triangles;
}

/// Everything that the options alone tell, before any file is opened.
void check_usage(const MapArguments& arguments) {
  check_usage(arguments.inputs);
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

void append(MapWriter& writer, std::span<const Point> points, std::span<const MapResult> results,
            std::span<const Certificate> certificates) {
  writer.append(points, results, certificates);
}

void append(MapWriter& writer, std::span<const Triangle> /*the mesh has them*/, std::span<const MapResult> results,
            std::span<const Certificate> certificates) {
  writer.append(results, certificates);
}

struct MappedStream {
  MapSummary summary;
  Clock::time_point first_element;  ///< when the first element was asked for: the device is ready then
};

template <typename Mapper, typename Stream>
MappedStream map_stream(Mapper mapper, Stream& stream, MapWriter& writer, bool show_progress) {
  using Element = typename Stream::Element;
  std::optional<ProgressBar> bar;  // begins at the first element: compiling kernels is no part of the rate
  auto first_element = Clock::now();
  const auto source = [&](std::span<Element> elements) {
    if (!bar) {
      first_element = Clock::now();
      bar.emplace(show_progress);
    }
    return stream.read(elements);
  };
  std::uint64_t done = 0;
  const auto sink = [&](std::span<const Element> elements, std::span<const MapResult> results,
                        std::span<const Certificate> certificates) {
    append(writer, elements, results, certificates);
    done += elements.size();
    bar->update(done, stream.fraction(done));
  };
  auto summary = mapper.map(source, sink);
  return {std::move(summary), first_element};
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

/// Maps `elements`, which `Stream` delivers and `Mapper` encloses, and prints the summary.
template <typename Mapper, typename Stream>
ExitStatus map_and_report(const UncertainModel& model, double point_radius, MapElements elements,
                          const MapArguments& arguments, const MapOptions& options) {
  Stream stream(arguments.inputs);
  watch_for_interruption();
  MapWriter writer(arguments.output, stream.mesh(),
                   arguments.certificates ? MapContents::certified : MapContents::enclosures, elements);
  const auto start = Clock::now();
  const auto [summary, first_element] =
      map_stream(Mapper(model, point_radius, options), stream, writer, !arguments.no_progress);
  const auto written = end_map(writer, summary, arguments.output);
  const auto end = Clock::now();

  if (!summary.notice.empty()) fmt::print(stderr, "verisq: {}\n", summary.notice);
  const MapReport report{.summary = summary,
                         .elements = elements,
                         .output = written,
                         .units = model.units,
                         .tolerance = options.tolerance,
                         .preparation_seconds = seconds_between(start, first_element),
                         .seconds = seconds_between(first_element, end)};
  fmt::print("{}", arguments.json ? json(report) : readable(report));
  return status_of(summary);
}

}  // namespace

const CLI::App& declare_map(CLI::App& program, MapArguments& arguments) {
  CLI::App& map = *program.add_subcommand("map", "Enclose the distance of each vertex, triangle or point to a model");
  map.footer(closing_words);
  declare_inputs(map, arguments.inputs);
  map.add_option("--on", arguments.on, "What of the mesh is mapped: vertices (default) or triangles")
      ->option_text("WHAT");
  map.add_option("--tol", arguments.tolerance,
                 "Largest width of a verified enclosure, in model units; 0 asks for the tightest.\n"
                 "Default: 1e-6 times the radius of the model's bounding sphere")
      ->option_text("NUMBER");
  map.add_option("--point-radius", arguments.point_radius,
                 "Each vertex or point is any within this distance of the given one, in model units (default 0)")
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
  const MapElements elements = parse_elements(arguments);
  std::optional<double> tolerance;
  if (arguments.tolerance) tolerance = parse_length("--tol", *arguments.tolerance);

  const double radius = parse_length("--point-radius", arguments.point_radius);

  const UncertainModel model = read_uncertain_model(arguments.inputs.model);
  const MapOptions options{.tolerance = tolerance ? *tolerance : default_tolerance(model),
                           .device = arguments.device,
                           .certificates = arguments.certificates,
                           .interrupted = interrupted};
  return elements == MapElements::vertices
             ? map_and_report<UncertainDistanceMapper, PointStream>(model, radius, elements, arguments, options)
             : map_and_report<UncertainTriangleMapper, TriangleStream>(model, radius, elements, arguments, options);
}

}  // namespace verisq::command_line
