/// `verisq map`, an enclosure of the distance for each vertex or triangle of a mesh or point of a file, and `verisq
/// merge`, the whole of a map from its parts.
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/map.hpp>
#include <verisq/map_file.hpp>

#include "host/command_line/inputs.hpp"
#include "host/command_line/options.hpp"
#include "host/command_line/outputs.hpp"
#include "host/command_line/run.hpp"
#include "host/command_line/shared_inputs.hpp"
#include "host/command_line/summaries.hpp"
#include "host/errors/refusal.hpp"
#include "host/prepare/mesh_geometry.hpp"
#include "verify/solids/model.hpp"

namespace verisq::command_line {
namespace {

// `verisq map`: an enclosure of the distance for each vertex or triangle of a mesh or point of a file.

/// As typed; `run_map` checks what depends on the files or on several options.
struct MapArguments {
  InputArguments inputs;
  MapElements on = MapElements::vertices;
  std::optional<double> tolerance;
  double point_radius = 0.0;
  PoseUncertaintyArguments pose_uncertainty;
  std::optional<unsigned> pose_divisions;
  std::optional<double> time_limit;  ///< in seconds
  std::string device = "auto";
  Method method = Method::duality;
  std::string output;                 ///< empty when only a report is requested, `-` for the standard output
  std::optional<std::string> format;  ///< an extension
  std::vector<MapColumn> columns;     ///< empty: the format's own columns
  std::optional<PartOption> part;
  ReportFiles report;
  bool certificates = false;
  bool closest_points = false;
  bool json = false;
  bool no_progress = false;
};

// `verisq merge`: the whole of a map whose parts several processes made.

struct MergeArguments {
  std::vector<std::string> parts;
  std::string output;
  bool mixed_devices = false;
  bool json = false;
};

constexpr const char* closing_words_of_map =
    R"(Each row of the map is [lo, hi], which contains the exact signed distance from the point to the model: positive
outside, negative inside; or the distance from the whole triangle, 0 where it meets the model. "Verified"
rows are at most the tolerance wide; "wide" ones are valid all the same. With --tol 0 those are verified that are
as tight as the methods get: at most 1e-12 of the largest coordinate or of the model's radius wide, of points
inside 2e-9 of the radius.
Where the model gives intervals [lo, hi] for semi-axes, exponents or translations, or points have a radius, each
row contains the distances of all that they allow: give a --tol above that uncertainty to call rows verified.
So it is where the model's place is known to a --translation-error and a --rotation-error, as of a tracked tool.
At the --time-limit running searches end and no other begins: every row is written all the same, and the rest is
valid, and wide. Ctrl-C, SIGTERM and SIGHUP keep the finished rows of a .csv or .npy under OUT.partial; a second
Ctrl-C stops at once, and a killed run leaves them under OUT.*.partial.
With -o - the rows go to the standard output and the summary to the standard error.
A closed mesh may be the --model, an implant as .stl, or a primitive of it: its solid is every point about which
its triangles wind. The host maps to it.
--report and --png draw the mesh, coloured by the proven distances of its vertices, and the model (of intervals
the largest); -o may be left out then.

Exit status: 0 every enclosure is at most the tolerance wide (or the tightest), 3 one is wider, 2 bad usage or
input, 130 interrupted by Ctrl-C, 143 by SIGTERM, 129 by SIGHUP.

Examples:
  verisq map --model stem.json --mesh femur.off -o clearance.vtp
  verisq map --model stem.stl --mesh femur.stl -o clearance.vtp
  verisq map --model stem.json --mesh femur.off --report clearance.html --png clearance.png
  verisq map --model stem.json --mesh femur.off --on triangles -o clearance.vtp
  verisq map --model stem.json --mesh femur.off --closest-points -o contacts.vtp
  verisq map --model stem.json --points samples.npy --columns x,y,z,lo,hi -o distances.npy
  verisq map --model stem.json --mesh femur.off --translation-error 0.5 --rotation-error 0.5 --tol 4 -o worst.csv
  verisq map --model stem.json --points samples.npy --part 3/8 -o distances.3.npy
  sample | verisq map --model stem.json --points - -o - | plot
  verisq map --model stem.json --points samples.csv --tol 1e-9 --device host -o distances.csv --json)";

constexpr const char* depth_of_overlaps =
    "certificates prove a depth by one primitive alone, and where primitives overlap their union is deeper; the map "
    "without --certificates is tighter there";

constexpr const char* depth_of_bends =
    "certificates prove depths in bent primitives where the ball about the point is more curved than the surface, "
    "exponents are at most 1 and there is no taper; the map without --certificates is tighter elsewhere";

double tolerance_of(const MapArguments& arguments, const Model& largest) {
  return arguments.tolerance ? *arguments.tolerance
                             : default_tolerance(tolerance_of_distances, bounding_radius(largest), "the model");
}

/// An inexact model or point is proven by single primitives alone. Distances of triangles to unions of convex
/// primitives are the least of the primitives' distances.
bool has_covers(const UncertainModel& model, const MapArguments& arguments) {
  const Model largest = bracket(model).largest;
  if (has_mesh(largest)) return false;
  const bool convex = is_union_of_convex(largest);
  const bool single = convex && (arguments.on == MapElements::triangles || model.primitives.size() == 1);
  return arguments.certificates && arguments.point_radius == 0.0 && is_exact(model) && !single;
}

/// The library refuses the same without naming file and option.
void refuse_what_needs_convexity(const UncertainModel& uncertain, const MapArguments& arguments) {
  const Model model = bracket(uncertain).largest;
  if (has_mesh(model) && arguments.method == Method::published)
    refuse(fmt::format("--method published: {}: not supported for meshes", arguments.inputs.model));
  if (is_union_of_convex(model) || has_mesh(model)) return;
  const auto refuse_option = [&](std::string_view option) {
    refuse(fmt::format("{}: {}: not supported for bends, nor for csg other than the union of all primitives", option,
                       arguments.inputs.model));
  };
  if (arguments.certificates && arguments.on == MapElements::triangles && !has_covers(uncertain, arguments))
    refuse_option("--certificates with --on triangles and --point-radius or intervals");
  if (arguments.certificates && !verify::is_union(model) && arguments.point_radius > 0.0) {
    refuse(
        fmt::format("--certificates with --point-radius: {}: not supported for csg other than the union of all "
                    "primitives",
                    arguments.inputs.model));
  }
  if (arguments.method == Method::published) refuse_option("--method published");
}

bool asks_for_closest_points(const MapArguments& arguments) {
  return arguments.closest_points || std::ranges::any_of(arguments.columns, is_of_closest_point);
}

void refuse_what_needs_exact_numbers(const UncertainModel& model, const MapArguments& arguments) {
  if (is_exact(model) || !asks_for_closest_points(arguments)) return;
  refuse(fmt::format("--closest-points: {}: not supported for intervals", arguments.inputs.model));
}

void check_method(const MapArguments& arguments) {
  if (arguments.method != Method::published) return;
  if (arguments.device != "host") refuse("--method published: runs on the host alone, give --device host");
  if (arguments.certificates) refuse("--method published: has no certificates");
}

const char* report_option(const MapArguments& arguments) {
  return arguments.report.html.empty() ? "--png" : "--report";
}

/// The library's writer refuses formats and elements that have none.
void check_closest_points(const MapArguments& arguments) {
  if (!asks_for_closest_points(arguments)) return;
  if (arguments.output.empty()) refuse("--closest-points: give the --output that has them");
  if (arguments.certificates) refuse("--closest-points: not with --certificates");
  if (arguments.point_radius > 0.0) refuse("--closest-points: of exact points only, not with --point-radius");
  if (pose_uncertainty(arguments.pose_uncertainty)) {
    refuse("--closest-points: of exact places only, not with --translation-error or --rotation-error");
  }
  if (arguments.on == MapElements::triangles) refuse("--closest-points: of vertices or points, not --on triangles");
}

MapContents contents_of(const UncertainModel& model, const MapArguments& arguments) {
  if (has_covers(model, arguments)) return MapContents::covered;
  if (arguments.certificates) return MapContents::certified;
  return asks_for_closest_points(arguments) ? MapContents::closest_points : MapContents::enclosures;
}

/// The closest points for the rows of one chunk; if nothing is proven, the map's own enclosure bounds the distance.
std::vector<ClosestPoint> closest_points_of(const SignedDistance& distance, std::span<const Point> points,
                                            std::span<const MapResult> results,
                                            const std::function<bool()>& interrupted) {
  std::vector<Enclosure> known;
  known.reserve(results.size());
  for (const MapResult& result : results) known.push_back(result.distance);
  std::vector<ClosestPoint> rows(points.size());
  closest_points(distance, points, rows, {.tolerance = 0.0, .known = known, .interrupted = interrupted});
  return rows;
}

void check_outputs(const MapArguments& arguments) {
  const std::vector<std::string> inputs{arguments.inputs.model, arguments.inputs.mesh, arguments.inputs.points};
  if (arguments.output.empty()) {
    if (!arguments.report.any()) refuse("give at least one of --output, --report, --png");
    if (arguments.certificates && arguments.report.html.empty()) {
      refuse("--certificates: give the --output or the --report that keeps them");
    }
    if (arguments.format) refuse("--format: give the --output that has it");
    if (!arguments.columns.empty()) refuse("--columns: give the --output that has them");
  } else {
    refuse_to_overwrite("-o", arguments.output, inputs);
  }
  check_usage(arguments.report, inputs, {arguments.output});
  check_closest_points(arguments);
  if (!arguments.report.any()) return;
  if (arguments.inputs.mesh.empty()) refuse(fmt::format("{}: give a --mesh to draw", report_option(arguments)));
  if (arguments.on == MapElements::triangles) {
    refuse(fmt::format("{}: shows rows of vertices, not --on triangles", report_option(arguments)));
  }
}

void check_pose_uncertainty(const MapArguments& arguments) {
  if (!pose_uncertainty(arguments.pose_uncertainty)) {
    if (arguments.pose_divisions) refuse("--pose-divisions: give the --translation-error or --rotation-error");
    return;
  }
  if (arguments.certificates) {
    refuse("--certificates: of exact places only, not with --translation-error or --rotation-error");
  }
  if (arguments.tolerance && *arguments.tolerance == 0.0) {
    refuse("--tol 0: not with --translation-error or --rotation-error, by which distances differ");
  }
  if (arguments.pose_divisions.value_or(1) > 1 && arguments.on == MapElements::triangles) {
    refuse("--pose-divisions: of vertices or points, not --on triangles");
  }
}

/// Rows of a part equal those of the whole only if they depend on nothing but their block.
void check_part(const MapArguments& arguments) {
  if (!arguments.part) return;
  if (format_of_drawn_part(arguments.output, arguments.format) == ".vtp") {
    if (arguments.on == MapElements::triangles) refuse("--part: triangles are written to .csv and .npy only");
    if (arguments.certificates) refuse("--part: certificates are written to .csv only");
  }
  if (arguments.report.any())
    refuse(fmt::format("--part: not with {}, which shows all rows", report_option(arguments)));
  if (arguments.time_limit) refuse("--part: not with --time-limit, by which rows depend on the clock");
  if (arguments.pose_divisions.value_or(1) > 1) {
    refuse("--part: not with --pose-divisions, by which rows depend on those beside them");
  }
  if (arguments.inputs.points == "-") refuse("--part: give a file of --points, which can be read again");
  const std::string part_file = part_file_of(arguments.output).string();
  refuse_to_overwrite("-o", part_file, {arguments.inputs.model, arguments.inputs.mesh, arguments.inputs.points});
}

/// Checks everything that the options alone determine, before any file is opened.
void check_usage(const MapArguments& arguments) {
  check_usage(arguments.inputs);
  check_outputs(arguments);
  check_method(arguments);
  check_pose_uncertainty(arguments);
  check_part(arguments);
  if (arguments.on == MapElements::triangles && arguments.inputs.mesh.empty()) {
    refuse("--on triangles: give their --mesh");
  }
}

/// The bone is drawn by its triangles, and coloured by rows of its vertices.
void refuse_what_cannot_be_drawn(const MapArguments& arguments, const Mesh* mesh) {
  if (!arguments.report.any() || (mesh != nullptr && !mesh->triangles.empty())) return;
  refuse(fmt::format("{}: {}: has no triangles to draw", report_option(arguments), arguments.inputs.mesh));
}

/// The page mentions exact distances: it must state the point radius.
std::vector<ReportLine> report_lines(const MapReport& report, const UncertainModel& model,
                                     const MapArguments& arguments) {
  std::vector<ReportLine> lines = report_lines(report);
  if (arguments.point_radius > 0.0) {
    const std::string units = units_behind(model.units);
    lines.push_back(
        {"each vertex", fmt::format("any point within {}{} of the drawn one", arguments.point_radius, units)});
  }
  if (arguments.inputs.pose) lines.push_back({"the model", "moved by --pose"});
  if (const auto bounds = pose_uncertainty(arguments.pose_uncertainty, arguments.inputs.pose)) {
    lines.push_back({"the model", described(*bounds, model.units) + "; drawn where it is nominally"});
  }
  if (!is_exact(model)) lines.push_back({"the model", "any within the intervals of its file; the largest is drawn"});
  return lines;
}

std::string file_name(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

/// For the page alone, which contains the model file's text: pipes cannot be read again.
void refuse_what_cannot_be_read_again(const MapArguments& arguments) {
  if (!arguments.certificates || arguments.report.html.empty()) return;
  for (const std::string& file : {arguments.inputs.model, arguments.inputs.mesh}) {
    if (std::filesystem::is_regular_file(file)) continue;
    refuse(
        fmt::format("--report with --certificates: {}: is no regular file, and the page must tell which it is", file));
  }
}

std::optional<ReportProof> proof_of(const ShownRows& rows, const MapArguments& arguments) {
  if (!arguments.certificates) return std::nullopt;
  return ReportProof{.certificates = rows.certificates,
                     .model_file = arguments.inputs.model,
                     .mesh_file = arguments.inputs.mesh,
                     .moved = arguments.inputs.pose.has_value(),
                     .point_radius = arguments.point_radius};
}

/// The given format; empty: by the name of the output.
std::string format_of(const MapArguments& arguments) {
  return arguments.format.value_or(arguments.output == "-" ? ".csv" : "");
}

/// Whatever rows depend on besides model, input and device; and their form.
std::vector<PartSetting> settings_of(const MapArguments& arguments, const MapOptions& options) {
  std::string columns;
  for (const MapColumn column : arguments.columns)
    columns += fmt::format("{}{}", columns.empty() ? "" : ",", to_string(column));
  std::vector<PartSetting> settings{{"command", "map"},
                                    {"format", format_of_drawn_part(arguments.output, arguments.format)},
                                    {"tolerance", fmt::format("{}", options.tolerance)},
                                    {"point_radius", fmt::format("{}", options.point_radius)},
                                    {"method", options.method == Method::duality ? "duality" : "published"},
                                    {"certificates", options.certificates ? "yes" : "no"},
                                    {"closest_points", asks_for_closest_points(arguments) ? "yes" : "no"},
                                    {"columns", columns}};
  if (arguments.inputs.pose) settings.push_back({"pose", option_text(*arguments.inputs.pose)});
  if (options.pose_uncertainty) settings.push_back({"place", text_of(*options.pose_uncertainty)});
  return settings;
}

/// The mapped elements: all elements of a stream, or those of a part.
template <class Stream>
std::optional<PartRecord> part_record(Stream& stream, MapElements elements, const MapArguments& arguments,
                                      const MapOptions& options) {
  if (!arguments.part) return std::nullopt;
  MapPart part{.part = arguments.part->part, .parts = arguments.part->parts};
  part.rows_in_all = count_elements(stream);
  part.rows = rows_of_part(part.part, part.parts, part.rows_in_all);
  part.elements = elements;
  part.settings = settings_of(arguments, options);
  return PartRecord(std::move(part), {arguments.inputs.model},
                    arguments.inputs.mesh.empty() ? arguments.inputs.points : arguments.inputs.mesh);
}

void draw(const UncertainModel& model, const Mesh& mesh, const ShownRows& rows, const MapReport& report,
          const MapArguments& arguments) {
  write(arguments.report, {.title = fmt::format("{}: distance to {}", file_name(arguments.inputs.mesh),
                                                file_name(arguments.inputs.model)),
                           .bone = mesh,
                           .rows = rows.results,
                           .implant = bracket(model).largest,
                           .units = model.units,
                           .summary = report_lines(report, model, arguments),
                           .area_names = {},
                           .area_of = {},
                           .solid_name = "model",
                           .proof = proof_of(rows, arguments)});
}

/// Maps `elements`, which `Stream` delivers, and prints the summary. Starts the limit, which the options ask for, when
/// the mapper is ready.
template <typename Stream>
ExitStatus map_and_report(const UncertainModel& model, MapElements elements, const MapArguments& arguments,
                          MapOptions options, Deadline& limit) {
  Stream stream(arguments.inputs);
  refuse_what_cannot_be_drawn(arguments, stream.mesh());
  if (stream.mesh() != nullptr)
    tell_of_other_size(bracket(model).largest, arguments.inputs.model, stream.mesh()->vertices, arguments.inputs.mesh);
  std::optional<PartRecord> part = part_record(stream, elements, arguments, options);
  PartStream elements_of_part(stream, part);
  PeekedStream peeked(elements_of_part);
  options.device = part ? part->device_for(options.device) : device_for(peeked, options.device);
  const auto make_mapper = [&] {
    Mapper<typename Stream::Element> mapper(model, options);
    limit.start();
    return mapper;
  };
  MapRequest request{.elements = elements,
                     .contents = contents_of(model, arguments),
                     .output = arguments.output,
                     .format = format_of(arguments),
                     .columns = arguments.columns,
                     .first_row = part ? part->rows().first : 0,
                     .rows = part ? part->rows().count : stream.count(),
                     .report = arguments.report,
                     .units = model.units,
                     .place = options.pose_uncertainty ? described(*options.pose_uncertainty, model.units) : "",
                     .tolerance = options.tolerance,
                     .show_progress = !arguments.no_progress,
                     .json = arguments.json};
  std::optional<SignedDistance> distance;
  if (request.contents == MapContents::closest_points) {
    distance.emplace(bracket(model).largest);
    request.closest = [&](std::span<const Point> points, std::span<const MapResult> results) {
      return closest_points_of(*distance, points, results, limit.stop());
    };
  }
  // At a time limit the reason is another one.
  if (arguments.certificates && !limit.given() && !options.covers) {
    const bool bent = !is_union_of_convex(bracket(model).largest);
    if (bent) request.why_wide_inside = depth_of_bends;
    if (!bent && model.primitives.size() > 1) request.why_wide_inside = depth_of_overlaps;
  }
  if (arguments.report.any()) {
    request.show = [&](const ShownRows& rows, const MapReport& report) {
      draw(model, *stream.mesh(), rows, report, arguments);
    };
  }
  if (part) {
    request.finished = [&](const MapSummary& summary, const std::optional<ClosestPointSummary>& closest) {
      part->write(arguments.output, summary, closest);
    };
  }
  // A part that is drawn has points alone, its own.
  const bool drawn_part = part && format_of_drawn_part(arguments.output, arguments.format) == ".vtp";
  return map_to_file(peeked, drawn_part ? nullptr : stream.mesh(), make_mapper, request);
}

void declare_map(Options& options, MapArguments& arguments) {
  options.explain(closing_words_of_map);
  declare_inputs(options, arguments.inputs);
  options.add("--on", arguments.on,
              choice<MapElements>({{"vertices", MapElements::vertices}, {"triangles", MapElements::triangles}}), "WHAT",
              "What of the mesh is mapped: vertices (default) or triangles");
  add_tolerance(options, arguments.tolerance, "the model");
  options.add("--point-radius", arguments.point_radius, parse_length, "NUMBER",
              "Each vertex or point is any within this distance of the given one, in model units (default 0)");
  add_pose_uncertainty(options, arguments.pose_uncertainty, "The model's");
  options.add(
      "--pose-divisions", arguments.pose_divisions, whole_number<unsigned>(1, 256), "NUMBER",
      "Of vertices or points: divides the places where the model may see a point, up to so often along each\n"
      "axis, for rows that are hardly wider than the distances differ. With 1 (default) they are so already outside\n"
      "of primitives without bends and csg; near edges, deep inside, of bends and csg 16 makes them so, and asks for\n"
      "some hundred distances a row");
  options.add("--time-limit", arguments.time_limit, parse_time_limit, "SECONDS",
              "Ends the map this long after its preparation: rows left open are valid, and wide (default: none)");
  options.add("--device", arguments.device, "DEVICE",
              fmt::format("{}; of points also several, which share them: 0,1", device_of_map_explanation));
  options.add("--method", arguments.method,
              choice<Method>({{"duality", Method::duality}, {"published", Method::published}}), "METHOD",
              "How the host proves points outside: duality (default), or published: the paper's bisected segment,\n"
              "to compare with (--device host)");
  options.add("-o,--output", arguments.output, "FILE", fmt::format("{}; - is the standard output", map_explanation));
  options.add(
      "--format", arguments.format,
      choice<std::string>({{"csv", ".csv"}, {"npy", ".npy"}, {"vtp", ".vtp"}, {"ply", ".ply"}, {"json", ".json"}}),
      "FORMAT", "Instead of the extension of -o: csv (default of -o -), npy, vtp, ply, json");
  options.add("--columns", arguments.columns, parse_columns, "NAMES",
              "Of a .csv or .npy, in this order: index,x,y,z,lo,hi,mid,width,status; with the closest points also\n"
              "unique,closest,normal,primitive. Default: index,lo,hi,status, of a .npy lo,hi,status, and those of the\n"
              "closest points where these are asked for");
  options.add_flag(
      "--closest-points", arguments.closest_points,
      "Write beside each distance the point of the model's surface that is closest, a box that is proven to\n"
      "contain it, the outward normal there, and which primitive it is of: .csv .npy .vtp, on the host.\n"
      "unique: whether it is proven to be the only one, and the normal to be the distance's gradient");
  add_part(options, arguments.part);
  declare_report_files(options, arguments.report);
  options.add_flag(
      "--certificates", arguments.certificates,
      "Write what proves each enclosure again, for `verisq check`: .csv .vtp; the page of --report then proves itself\n"
      "again in any browser. What single primitives do not prove, of bends, overlaps and set operations, the host\n"
      "proves by covers");
  add_json_of_enclosures(options, arguments.json);
  add_no_progress(options, arguments.no_progress);
}

/// Throws Error(input) for errors that the user can correct, before the first distance is computed (a file of points is
/// a stream: its later lines are checked as they come).
ExitStatus run_map(const MapArguments& arguments) {
  check_usage(arguments);
  Deadline limit(arguments.time_limit, interrupted);
  const UncertainModel model = read_uncertain_model_at(arguments.inputs.pose, arguments.inputs.model);
  const Model largest = bracket(model).largest;
  refuse_what_needs_convexity(model, arguments);
  refuse_what_cannot_be_read_again(arguments);
  refuse_what_needs_exact_numbers(model, arguments);
  MapOptions options{.tolerance = tolerance_of(arguments, largest),
                     .device = arguments.device,
                     .certificates = arguments.certificates,
                     .covers = has_covers(model, arguments),
                     .method = arguments.method,
                     .point_radius = arguments.point_radius,
                     .pose_uncertainty = pose_uncertainty(arguments.pose_uncertainty, arguments.inputs.pose),
                     .pose_divisions = arguments.pose_divisions.value_or(1),
                     .interrupted = interrupted,
                     .out_of_time = limit.out_of_time()};
  const MapElements elements = arguments.on;
  return elements == MapElements::vertices ? map_and_report<PointStream>(model, elements, arguments, options, limit)
                                           : map_and_report<TriangleStream>(model, elements, arguments, options, limit);
}

}  // namespace

Command map_command() {
  return command("map", "Enclose the distance of each vertex, triangle or point to a model", declare_map, run_map);
}

namespace {

constexpr const char* closing_words_of_merge =
    R"(PARTS are the files that `verisq map --part I/N -o PART` or `verisq distance --poses F --part I/N -o PART` wrote,
all N of them, in any order; beside each lies its PART.part.json. The whole is bit by bit what one process writes on
the same kind of device; of .vtp parts it is a .pvtp, which names them and is opened by ParaView as one. Refused are
gaps and overlaps, parts of other models, inputs, options, devices or versions
of verisq, and files that are not those that were written.

Exit status: that of the whole map: 0 every enclosure is at most the tolerance wide, 3 one is wider, 2 the parts do
not belong together.

Example:
  for i in 1 2 3 4; do verisq map --model stem.json --points samples.npy --part $i/4 -o part.$i.npy; done
  verisq merge part.*.npy -o distances.npy)";

std::string tolerance_of(const MapPart& whole) {
  const auto found = std::ranges::find(whole.settings, "tolerance", &PartSetting::name);
  return found == whole.settings.end() ? std::string() : found->value;
}

std::string readable(const MergedMap& merged, const MergeArguments& arguments, double seconds) {
  const MapSummary& summary = merged.whole.summary;
  std::string text = fmt::format("{:<19}{}\n", plural(merged.whole.elements), summary.points);
  text += fmt::format("  device-verified  {}\n", summary.device_verified);
  text += fmt::format("  host-verified    {}\n", summary.host_verified);
  text += fmt::format("  wide             {}\n", summary.wide);
  text += fmt::format("parts              {}\n", arguments.parts.size());
  text += fmt::format("device             {}\n", quotation(summary.device));
  text += fmt::format("tolerance          {}\n", tolerance_of(merged.whole));
  if (summary.points > 0) {
    text += fmt::format("smallest distance  [{}, {}]{}\n", summary.minimum_lo, summary.minimum_hi,
                        whose_distance(merged.whole.elements));
    text += fmt::format("largest width      {}\n", upper_digits(summary.largest_width));
  }
  if (merged.whole.closest) text += fmt::format("closest points     {} unique\n", merged.whole.closest->unique);
  text += fmt::format("time               {:.3g} s (in all parts: device {:.3g} s, host proofs {:.3g} s)\n", seconds,
                      summary.device_seconds, summary.host_seconds);
  return text + fmt::format("map                {}\n", quotation(arguments.output));
}

std::string json(const MergedMap& merged, const MergeArguments& arguments, double seconds) {
  const MapSummary& summary = merged.whole.summary;
  JsonObject object{{plural(merged.whole.elements), summary.points},
                    {"device_verified", summary.device_verified},
                    {"host_verified", summary.host_verified},
                    {"wide", summary.wide},
                    {"parts", arguments.parts.size()},
                    {"devices", merged.devices},
                    {"largest_width", summary.largest_width},
                    {"device_seconds", summary.device_seconds},
                    {"host_seconds", summary.host_seconds},
                    {"seconds", seconds},
                    {"output", arguments.output}};
  if (summary.points > 0) object.set("smallest_distance", Enclosure{summary.minimum_lo, summary.minimum_hi});
  if (merged.whole.closest) object.set("unique_closest_points", merged.whole.closest->unique);
  JsonObject settings;
  for (const auto& [name, value] : merged.whole.settings) settings.set(name, value);
  object.set("settings", settings);
  return object.text() + "\n";
}

void declare_merge(Options& options, MergeArguments& arguments) {
  options.explain(closing_words_of_merge);
  options.require_each("PARTS", arguments.parts, "PARTS",
                       "All parts of a map: .csv, .npy or .vtp, each with its .part.json");
  options.require("-o,--output", arguments.output, "FILE", "The whole map; of .vtp parts a .pvtp");
  options.add_flag("--mixed-devices", arguments.mixed_devices,
                   "Accept parts of several devices: every row is valid, but which bits it has is then the device's");
  options.add_flag("--json", arguments.json, "Print the summary as one JSON object; what is not bounded is null");
}

/// The status of the whole map. Throws Error(input) for parts that do not belong together.
ExitStatus run_merge(const MergeArguments& arguments) {
  const Stopwatch time;
  const std::vector<std::filesystem::path> parts(arguments.parts.begin(), arguments.parts.end());
  const MergedMap merged = merge_maps(parts, arguments.output, {.mixed_devices = arguments.mixed_devices});
  const double seconds = time.seconds();
  fmt::print("{}", arguments.json ? json(merged, arguments, seconds) : readable(merged, arguments, seconds));
  return merged.whole.summary.wide > 0 ? ExitStatus::unverified : ExitStatus::verified;
}

}  // namespace

Command merge_command() {
  return command("merge", "Make one map of all its parts, after checking that they belong together", declare_merge,
                 run_merge);
}

}  // namespace verisq::command_line
