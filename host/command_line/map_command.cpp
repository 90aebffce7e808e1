/// Reads the options and files of `verisq map`, runs the map, reports.
#include "host/command_line/map_command.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <verisq/error.hpp>
#include <verisq/map.hpp>
#include <verisq/map_file.hpp>
#include <verisq/model_file.hpp>
#include <verisq/signed_distance.hpp>

#include "host/command_line/interruption.hpp"
#include "host/command_line/length_option.hpp"
#include "host/command_line/map_to_file.hpp"
#include "host/command_line/time_limit.hpp"
#include "host/command_line/triangle_stream.hpp"

namespace verisq::command_line {
namespace {

constexpr double default_relative_tolerance = 1e-6;  // of the radius of the model's bounding sphere

constexpr const char* closing_words =
    "Each row of the map is [lo, hi], which contains the exact signed distance from the point to the model: positive\n"
    "outside, negative inside; or the distance from the whole triangle, 0 where it meets the model. \"Verified\"\n"
    "rows are at most the tolerance wide; \"wide\" ones are valid all the same. With --tol 0 those are verified that "
    "are\n"
    "as tight as the methods get: at most 1e-12 of the largest coordinate or of the model's radius wide, of points\n"
    "inside 2e-9 of the radius.\n"
    "Where the model gives intervals [lo, hi] for semi-axes, exponents or translations, or points have a radius, each\n"
    "row contains the distances of all that they allow: give a --tol above that uncertainty to call rows verified.\n"
    "At the --time-limit running searches end and no other begins: every row is written all the same, and the rest is\n"
    "valid, and wide. Ctrl-C, SIGTERM and SIGHUP keep the finished rows of a .csv under OUT.partial; a second Ctrl-C\n"
    "stops at once, and a killed run leaves them under OUT.*.partial: `check` proves both.\n"
    "--report and --png draw the mesh, coloured by the proven distances of its vertices, and the model (of intervals\n"
    "the largest); -o may be left out then.\n"
    "\n"
    "Exit status: 0 every enclosure is at most the tolerance wide (or the tightest), 3 one is wider, 2 bad usage or\n"
    "input, 130 interrupted by Ctrl-C, 143 by SIGTERM, 129 by SIGHUP.\n"
    "\n"
    "Examples:\n"
    "  verisq map --model stem.json --mesh femur.off -o clearance.vtp\n"
    "  verisq map --model stem.json --mesh femur.off --report clearance.html --png clearance.png\n"
    "  verisq map --model stem.json --mesh femur.off --on triangles -o clearance.vtp\n"
    "  verisq map --model stem.json --points samples.csv --tol 1e-9 --device host -o distances.csv --json";

constexpr const char* depth_of_overlaps =
    "certificates prove a depth by one primitive alone, and where primitives overlap their union is deeper; the map "
    "without --certificates is tighter there";

[[noreturn]] void refuse(const std::string& message) {
  throw Error(ErrorKind::input, message);
}

double default_tolerance(const Model& largest) {
  const double tolerance = default_relative_tolerance * bounding_radius(largest);
  // An infinite tolerance would call every enclosure verified.
  if (!std::isfinite(tolerance)) refuse("--tol: give one, because the size of the model overflows");
  return tolerance;
}

/// The library refuses the same without naming file and option.
void refuse_what_needs_convexity(const Model& model, const MapArguments& arguments) {
  if (is_union_of_convex(model)) return;
  const auto refuse_option = [&](std::string_view option) {
    refuse(fmt::format("{}: {}: not supported for bends, nor for csg other than the union of all primitives", option,
                       arguments.inputs.model));
  };
  if (arguments.on == "triangles") refuse_option("--on triangles");
  if (arguments.certificates) refuse_option("--certificates");
  if (arguments.method == "published") refuse_option("--method published");
}

MapElements parse_elements(const MapArguments& arguments) {
  if (arguments.on == "vertices") return MapElements::vertices;
  if (arguments.on != "triangles") refuse(fmt::format("--on: {} is not one of vertices, triangles", arguments.on));
  if (arguments.inputs.mesh.empty()) refuse("--on triangles: give their --mesh");
  return MapElements::triangles;
}

Method parse_method(const MapArguments& arguments) {
  if (arguments.method == "duality") return Method::duality;
  if (arguments.method != "published") {
    refuse(fmt::format("--method: {} is not one of duality, published", arguments.method));
  }
  if (arguments.device != "host") refuse("--method published: runs on the host alone, give --device host");
  if (arguments.certificates) refuse("--method published: has no certificates");
  return Method::published;
}

const char* report_option(const MapArguments& arguments) {
  return arguments.report.html.empty() ? "--png" : "--report";
}

void check_outputs(const MapArguments& arguments) {
  const std::initializer_list<std::string> inputs{arguments.inputs.model, arguments.inputs.mesh,
                                                  arguments.inputs.points};
  if (arguments.output.empty()) {
    if (!arguments.report.any()) refuse("give at least one of --output, --report, --png");
    if (arguments.certificates) refuse("--certificates: give the --output that keeps them");
  } else {
    refuse_to_overwrite(arguments.output, inputs);
  }
  if (!arguments.report.any()) return;
  if (arguments.inputs.mesh.empty()) refuse(fmt::format("{}: give a --mesh to draw", report_option(arguments)));
  if (arguments.on == "triangles") {
    refuse(fmt::format("{}: shows rows of vertices, not --on triangles", report_option(arguments)));
  }
  check_usage(arguments.report, inputs);
}

/// Everything that the options alone tell, before any file is opened.
void check_usage(const MapArguments& arguments) {
  check_usage(arguments.inputs);
  check_outputs(arguments);
}

/// The bone is drawn by its triangles, and coloured by rows of its vertices.
void refuse_what_cannot_be_drawn(const MapArguments& arguments, const Mesh* mesh) {
  if (!arguments.report.any() || (mesh != nullptr && !mesh->triangles.empty())) return;
  refuse(fmt::format("{}: {}: has no triangles to draw", report_option(arguments), arguments.inputs.mesh));
}

/// The page speaks of exact distances: it must say of what.
std::vector<ReportLine> report_lines(const MapReport& report, const UncertainModel& model, double point_radius) {
  std::vector<ReportLine> lines = report_lines(report);
  if (point_radius > 0.0) {
    const std::string units = model.units.empty() ? std::string() : " " + model.units;
    lines.push_back({"each vertex", fmt::format("any point within {}{} of the drawn one", point_radius, units)});
  }
  if (!is_exact(model)) lines.push_back({"the model", "any within the intervals of its file; the largest is drawn"});
  return lines;
}

std::string file_name(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

/// Maps `elements`, which `Stream` delivers, and prints the summary. Starts the limit, which the options ask for, when
/// the mapper is ready.
template <typename Stream>
ExitStatus map_and_report(const UncertainModel& model, MapElements elements, const MapArguments& arguments,
                          const MapOptions& options, TimeLimit& limit) {
  Stream stream(arguments.inputs);
  refuse_what_cannot_be_drawn(arguments, stream.mesh());
  const auto make_mapper = [&] {
    Mapper<typename Stream::Element> mapper(model, options);
    limit.start();
    return mapper;
  };
  MapRequest request{.elements = elements,
                     .contents = arguments.certificates ? MapContents::certified : MapContents::enclosures,
                     .output = arguments.output,
                     .report = arguments.report,
                     .units = model.units,
                     .tolerance = options.tolerance,
                     .show_progress = !arguments.no_progress,
                     .json = arguments.json};
  // At a time limit there is another reason.
  if (arguments.certificates && model.primitives.size() > 1 && !limit.given()) {
    request.why_wide_inside = depth_of_overlaps;
  }
  if (arguments.report.any()) {
    request.show = [&](std::span<const MapResult> rows, const MapReport& report) {
      write(arguments.report, {.title = fmt::format("{}: distance to {}", file_name(arguments.inputs.mesh),
                                                    file_name(arguments.inputs.model)),
                               .bone = *stream.mesh(),
                               .rows = rows,
                               .implant = bracket(model).largest,
                               .units = model.units,
                               .summary = report_lines(report, model, options.point_radius),
                               .area_names = {},
                               .area_of = {}});
    };
  }
  return map_to_file(stream, stream.mesh(), make_mapper, request);
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
  map.add_option("--time-limit", arguments.time_limit,
                 "Ends the map this long after its preparation: rows left open are valid, and wide (default: none)")
      ->option_text("SECONDS");
  map.add_option("--device", arguments.device,
                 "auto (default), host (no OpenCL), or an index or part of a name from `verisq devices`")
      ->option_text("DEVICE");
  map.add_option("--method", arguments.method,
                 "How the host proves points outside: duality (default), or published: the paper's bisected segment,\n"
                 "to compare with (--device host)")
      ->option_text("METHOD");
  map.add_option("-o,--output", arguments.output, "The map, by extension: .csv .vtp .ply .json")->option_text("FILE");
  declare_report_files(map, arguments.report);
  map.add_flag(
      "--certificates", arguments.certificates,
      "Write what proves each enclosure again, for `verisq check`: .csv .vtp. Points inside are proven by one\n"
      "primitive alone: where primitives overlap, rows are wider than without, and may be wide");
  map.add_flag("--json", arguments.json, "Print the summary as one JSON object; what is not bounded is null");
  map.add_flag("--no-progress", arguments.no_progress, "No progress bar, even on a terminal");
  return map;
}

ExitStatus run_map(const MapArguments& arguments) {
  check_usage(arguments);
  const Method method = parse_method(arguments);
  const MapElements elements = parse_elements(arguments);
  std::optional<double> tolerance;
  if (arguments.tolerance) tolerance = parse_length("--tol", *arguments.tolerance);

  const double radius = parse_length("--point-radius", arguments.point_radius);
  TimeLimit limit(parse_time_limit(arguments.time_limit));

  const UncertainModel model = read_uncertain_model(arguments.inputs.model);
  const Model largest = bracket(model).largest;
  refuse_what_needs_convexity(largest, arguments);
  MapOptions options{.tolerance = tolerance ? *tolerance : default_tolerance(largest),
                     .device = arguments.device,
                     .certificates = arguments.certificates,
                     .method = method,
                     .point_radius = radius,
                     .interrupted = interrupted};
  if (limit.given()) options.out_of_time = [&limit] { return limit.passed(); };
  return elements == MapElements::vertices ? map_and_report<PointStream>(model, elements, arguments, options, limit)
                                           : map_and_report<TriangleStream>(model, elements, arguments, options, limit);
}

}  // namespace verisq::command_line
