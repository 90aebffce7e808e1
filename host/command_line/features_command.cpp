/// `verisq features`: head, neck, shaft and condyles of a femur, and a surgeon's measurements of them, as intervals.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>
#include <verisq/certificate_file.hpp>
#include <verisq/error.hpp>
#include <verisq/features.hpp>
#include <verisq/files.hpp>
#include <verisq/map.hpp>
#include <verisq/mesh_topology.hpp>
#include <verisq/report.hpp>

#include "host/command_line/inputs.hpp"
#include "host/command_line/options.hpp"
#include "host/command_line/outputs.hpp"
#include "host/command_line/run.hpp"
#include "host/command_line/summaries.hpp"
#include "host/errors/refusal.hpp"
#include "host/prepare/femur_axes.hpp"

namespace verisq::command_line {
namespace {

// The output of `verisq features`.

struct FeaturesReport {
  FemurLandmarks landmarks;
  std::optional<Side> side;
  double landmark_radius;
  std::vector<std::string> notes = {};  ///< how the landmarks were found
  FemurFeatures bone = {};
  std::vector<std::string> implant_notes = {};  ///< the points of the implant that count
  std::optional<FemurFeatures> changes = {};    ///< changes by an implant
};

/// As typed; `run_features` checks what depends on several of them.
struct FeaturesArguments {
  std::string mesh;
  std::string model;
  double deviation = 0.3;  ///< of the model's mesh, in mm
  std::string landmarks;
  std::optional<Side> side;
  double landmark_radius = 0.0;
  std::string implant;
  std::string implant_head;  ///< empty: the point in the implant's file, else the centre of its primitive "head"
  std::string implant_neck;
  std::string written_landmarks;
  std::string axes;
  std::string certificate_file;
  std::string device = "auto";
  ReportFiles report;
  bool json = false;
  bool no_progress = false;
};

const char* unit_of(const Feature& feature) {
  return feature.unit == FeatureUnit::length ? "mm" : "deg";
}

std::string value_of(const Feature& feature) {
  return fmt::format("{} {}", outward_digits(feature.value), unit_of(feature));
}

/// The effect of a change, in a surgeon's words.
struct Consequence {
  std::string_view name;
  const char* of_more;
  const char* of_less;
};
constexpr std::array consequences{
    Consequence{"offset_change", "more offset", "less offset"},
    Consequence{"length_change", "leg longer", "leg shorter"},
    Consequence{"version_change", "neck farther ahead: more anteversion", "neck farther back: less anteversion"},
    Consequence{"ccd_change", "neck steeper: valgus", "neck flatter: varus"},
};

/// Only if it holds for the whole interval.
std::string consequence_of(const Feature& feature) {
  const auto* const found = std::ranges::find(consequences, feature.name, &Consequence::name);
  if (found == consequences.end()) return {};
  if (feature.value.lo > 0.0) return fmt::format("   {}", found->of_more);
  if (feature.value.hi < 0.0) return fmt::format("   {}", found->of_less);
  return "   more or less: not decided at this landmark radius";
}

std::string text(const Point& point) {
  return fmt::format("{:.4f}, {:.4f}, {:.4f}", point[0], point[1], point[2]);
}

std::string side_name(const std::optional<Side>& side) {
  if (!side) return "not known";
  return *side == Side::left ? "left" : "right";
}

std::string table(const FemurFeatures& found) {
  std::string result;
  for (const Feature& feature : found.features) {
    result += fmt::format("{:<28}{}{}\n", feature.name, value_of(feature), consequence_of(feature));
    result += fmt::format("{:<28}  {}\n", "", feature.method);
  }
  for (const std::string& missing : found.missing) result += fmt::format("missing: {}\n", missing);
  return result;
}

std::string table(const FemurFrame& frame) {
  std::string result = fmt::format("frame (ISB), origin         {}\n", text(frame.origin));
  const auto axis = [&](const char* name, const FrameAxis& of) {
    result += fmt::format("  {:<26}{:.7f}, {:.7f}, {:.7f}, within {:.3g} deg\n", name, of.direction[0], of.direction[1],
                          of.direction[2], of.tilt_degrees);
  };
  axis("x, ahead", frame.x);
  axis("y, up", frame.y);
  axis("z, to the right", frame.z);
  return result;
}

JsonValue json_of(const FemurFeatures& found) {
  JsonValue::Array features;
  for (const Feature& feature : found.features) {
    features.push_back(JsonObject{
        {"name", feature.name}, {"method", feature.method}, {"unit", unit_of(feature)}, {"value", feature.value}});
  }
  return {features};
}

JsonValue json_of(const FrameAxis& axis) {
  return JsonObject{{"direction", axis.direction}, {"tilt_degrees", axis.tilt_degrees}};
}

JsonValue json_of(const std::optional<FemurFrame>& frame) {
  if (!frame) return {};
  return JsonObject{
      {"origin", frame->origin}, {"x", json_of(frame->x)}, {"y", json_of(frame->y)}, {"z", json_of(frame->z)}};
}

JsonValue json_of(const FemurLandmarks& landmarks) {
  JsonObject result;
  for (const auto& [name, point] : named_landmarks) {
    if (const std::optional<Point>& at = landmarks.*point) result.set(name, *at);
  }
  return result;
}

/// Tables for people.
std::string readable(const FeaturesReport& report) {
  std::string result = fmt::format("side                        {}\n", side_name(report.side));
  for (const std::string& note : report.notes) result += fmt::format("found               {}\n", note);
  for (const auto& [name, point] : named_landmarks) {
    if (const std::optional<Point>& at = report.landmarks.*point) result += fmt::format("{:<28}{}\n", name, text(*at));
  }
  result += report.landmark_radius > 0.0
                ? fmt::format("\nProven for all landmarks within {:.6g} mm of these:\n", report.landmark_radius)
                : "\nIf these landmarks were exact (--landmark-radius says how well they are known):\n";
  result += table(report.bone);
  if (report.bone.frame) result += table(*report.bone.frame);
  if (!report.changes) return result;
  result += "\nThe implant in its place, its own points exact, against the bone as it was:\n";
  for (const std::string& note : report.implant_notes) result += fmt::format("implant's           {}\n", note);
  return result + table(*report.changes);
}

/// One line of JSON.
std::string json(const FeaturesReport& report) {
  const JsonObject object{
      {"side", report.side ? JsonValue(side_name(report.side)) : JsonValue()},
      {"landmark_radius", report.landmark_radius},
      {"head_radius", report.landmarks.head_radius},
      {"landmarks", json_of(report.landmarks)},
      {"notes", report.notes},
      {"features", json_of(report.bone)},
      {"frame", json_of(report.bone.frame)},
      {"missing", report.bone.missing},
      {"implant_points", report.implant_notes},
      {"changes", report.changes ? json_of(*report.changes) : JsonValue()},
      {"changes_missing", report.changes ? JsonValue(report.changes->missing) : JsonValue()},
  };
  return object.text() + "\n";
}

/// The features for a report's table, an implant's changes first: a picture has room for a few lines.
std::vector<ReportLine> report_lines(const FeaturesReport& report) {
  std::vector<ReportLine> lines{{"side", side_name(report.side)},
                                {"landmarks known to", fmt::format("{:.6g} mm", report.landmark_radius)}};
  if (report.changes) {
    for (const Feature& feature : report.changes->features)
      lines.push_back(
          {fmt::format("{} ({})", feature.name, feature.method), value_of(feature) + consequence_of(feature)});
  }
  for (const Feature& feature : report.bone.features)
    lines.push_back({fmt::format("{} ({})", feature.name, feature.method), value_of(feature)});
  return lines;
}

constexpr const char* closing_words =
    "Landmarks are found in floating point, in millimetres: look at them (--report). Those of --landmarks take the "
    "place\n"
    "of what was found; where they hold head, neck and shaft, nothing is sought. What is proven: each interval holds "
    "the\n"
    "feature for every choice of the landmarks within --landmark-radius of where they are. Methods of version differ "
    "by\n"
    "up to 18 degrees (Murphy), so that each is named. Angles of version are positive ahead.\n"
    "\n"
    "Of a model of a femur (--model, as `verisq recover` writes it) its surface is meshed first, to --deviation by\n"
    "estimate; landmarks are those of that mesh, but for those that the model's file names.\n"
    "\n"
    "Of an implant in its place (--implant, as `verisq fit` writes it) the changes of offset, of leg length, of "
    "version\n"
    "and of CCD follow, of the points that its file names (head_centre, neck_centre, shaft_proximal, shaft_distal), "
    "else\n"
    "of the centres of its primitives --head and --neck. They are exact, the bone's are known to --landmark-radius.\n"
    "\n"
    "Exit status: 0 all features of the landmarks that are there; 3 some need landmarks that are known better, or the\n"
    "implant's or the bone's are missing for its changes; 2 bad usage or input, or no femur.\n"
    "\n"
    "Examples:\n"
    "  verisq features --mesh femur.stl --report features.html\n"
    "  verisq features --mesh femur.stl --landmark-radius 1 -o landmarks.json --json\n"
    "  verisq features --model recovered.json --landmark-radius 2\n"
    "  verisq features --mesh femur.stl --implant examples/tapered_stem.json --landmark-radius 1 --png planned.png\n"
    "  verisq features --landmarks landmarks.json --implant fitted.json --landmark-radius 1";

void check_usage(const FeaturesArguments& arguments) {
  if (!arguments.mesh.empty() && !arguments.model.empty()) refuse("--mesh and --model: give one of them");
  const bool has_surface = !arguments.mesh.empty() || !arguments.model.empty();
  if (!has_surface && arguments.landmarks.empty()) refuse("give --mesh, --model or --landmarks");
  const std::vector<std::string> inputs{arguments.mesh, arguments.model, arguments.landmarks, arguments.implant};
  if (arguments.report.any() && !has_surface) refuse("--report and --png: want a --mesh or a --model");
  if (arguments.implant.empty() && !(arguments.implant_head.empty() && arguments.implant_neck.empty()))
    refuse("--head and --neck: want an --implant");
  check_usage(arguments.report, inputs, {arguments.written_landmarks, arguments.axes, arguments.certificate_file});
  check_certificate_file(arguments.certificate_file, inputs);
  if (!arguments.written_landmarks.empty()) refuse_to_overwrite("-o", arguments.written_landmarks, inputs);
  if (!arguments.axes.empty()) refuse_to_overwrite("--axes", arguments.axes, inputs);
}

/// Given landmarks replace the found ones.
void override_landmarks(FemurLandmarks& found, const FemurLandmarks& given) {
  for (const auto& [name, point] : named_landmarks) {
    if (given.*point) found.*point = given.*point;
  }
  if (given.head_radius) found.head_radius = given.head_radius;
}

std::optional<Side> side_of(const FeaturesArguments& arguments, const std::optional<LandmarkFile>& given) {
  const std::optional<Side> of_file = given ? given->side : std::nullopt;
  if (arguments.side && of_file && *arguments.side != *of_file)
    refuse(fmt::format("--side: {} says the other side", arguments.landmarks));
  return arguments.side ? arguments.side : of_file;
}

/// Returns whether no landmark must be found: then a mesh serves only for drawing.
bool has_all_of_a_proximal_femur(const FemurLandmarks& landmarks) {
  return landmarks.head_centre && landmarks.head_radius && landmarks.neck_centre && landmarks.shaft_proximal &&
         landmarks.shaft_distal;
}

DetectedFemur detected(const Mesh& mesh, const std::string& file, const std::optional<Side>& side) {
  try {
    return detect_femur(mesh, side);
  } catch (const Error& error) {
    throw Error(error.kind(), fmt::format("{}: {}", file, error.what()));
  }
}

/// A bone's surface, and its file.
struct Surface {
  std::string file;
  Mesh mesh;
  std::string note = {};  ///< how it was made, if it was made
  FemurLandmarks named = {};
};

/// Nothing if interrupted.
std::optional<Surface> meshed(const FeaturesArguments& arguments) {
  const Model model = read_model(arguments.model);
  if (!model.units.empty() && model.units != "mm")
    refuse(fmt::format("{}: units {}: a femur is measured in mm", arguments.model, quotation(model.units)));
  ModelMesh found = model_mesh(model, {.deviation = arguments.deviation, .interrupted = interrupted});
  if (found.interrupted) return std::nullopt;
  return Surface{arguments.model, std::move(found.mesh),
                 fmt::format("surface: the model's, meshed to {:.2g} mm by estimate; nothing of that is proven",
                             found.estimated_deviation),
                 read_model_landmarks(arguments.model)};
}

/// An implant in its place, with the points that count.
struct Implant {
  Model model;
  FemurLandmarks points;
  std::vector<std::string> notes = {};
};

void check_primitive(const FeaturesArguments& arguments, const Model& implant, const char* option,
                     const std::string& name) {
  if (!name.empty() && std::ranges::count(implant.primitives, name, &Primitive::name) == 0)
    refuse(fmt::format("{}: {} has no primitive {}", option, arguments.implant, quotation(name)));
}

Implant read_implant(const FeaturesArguments& arguments) {
  Model model = read_model(arguments.implant);
  check_primitive(arguments, model, "--head", arguments.implant_head);
  check_primitive(arguments, model, "--neck", arguments.implant_neck);
  std::vector<features::NamedCentre> centres;
  for (const Primitive& primitive : model.primitives) centres.push_back({primitive.name, primitive.pose.translation});
  auto [points, notes] = features::implant_points(read_model_landmarks(arguments.implant), centres,
                                                  {arguments.implant_head, arguments.implant_neck});
  if (!points.head_centre) {
    refuse(
        fmt::format("{}: names no landmark head_centre and has no primitive \"head\"; give --head", arguments.implant));
  }
  return {std::move(model), points, std::move(notes)};
}

/// The axes, and the implant among them where there is one.
Model figure_of(const Model& axes, const std::optional<Implant>& implant) {
  if (!implant) return axes;
  Model figure = implant->model;
  if (figure.csg) figure.csg = SetExpression{.operands = {*figure.csg}, .operation = SetOperation::unite};
  for (Primitive& primitive : figure.primitives) primitive.name = "implant: " + primitive.name;
  for (const Primitive& primitive : axes.primitives) {
    if (primitive.name == features::drawn_head) continue;  // the implant has its own
    if (figure.csg) {
      figure.csg->operands.push_back({.primitive = static_cast<std::uint32_t>(figure.primitives.size())});
    }
    figure.primitives.push_back(primitive);
  }
  return figure;
}

/// Returns whether each feature whose landmarks exist is enclosed: exact landmarks would give no more features.
bool says_all(const FeaturesReport& report) {
  const FemurFeatures exactly = femur_features(report.landmarks, report.side, 0.0);
  return report.bone.features.size() == exactly.features.size() &&
         report.bone.frame.has_value() == exactly.frame.has_value() &&
         (!report.changes || report.changes->missing.empty());
}

/// The bone with the axes in it, coloured by the distance to them. False where it was interrupted.
bool draw(const FeaturesArguments& arguments, const Mesh& mesh, const Model& figure, const FeaturesReport& report) {
  std::vector<MapResult> rows(mesh.vertices.size());
  const MapOptions options{.tolerance = 1e-6, .device = arguments.device, .interrupted = interrupted};
  const MapSummary summary = PointMapper(figure, options).map(mesh.vertices, rows);
  if (summary.interrupted) {
    tell("interrupted; report and picture are not written");
    return false;
  }
  write(arguments.report, {.title = report.changes ? "Features of a femur: the figure is its axes and the implant"
                                                   : "Features of a femur: the figure is its head and axes",
                           .bone = mesh,
                           .rows = rows,
                           .implant = figure,
                           .units = "mm",
                           .summary = report_lines(report),
                           .area_names = {},
                           .area_of = {},
                           .solid_name = "figure"});
  return true;
}

void write_certificate(const FeaturesArguments& arguments, const std::optional<Surface>& surface,
                       const std::optional<Implant>& implant, const FeaturesReport& report) {
  FeaturesAnswer answer{.implant = {},
                        .mesh = {},
                        .claims = {.landmarks = report.landmarks,
                                   .side = report.side,
                                   .landmark_radius = report.landmark_radius,
                                   .features = report.bone.features,
                                   .frame = report.bone.frame}};
  if (surface) answer.mesh = subject_file(surface->file);
  if (implant) {
    answer.implant = subject_file(arguments.implant);
    answer.claims.implant = implant->points;
    answer.claims.changes = report.changes->features;
  }
  write_answer(arguments.certificate_file, std::move(answer));
}

/// Detects the landmarks on `surface` and puts them, the side and the notes into `report`. A landmark that the
/// surface's file names comes before one that is detected.
void detect_landmarks(const Surface& surface, FeaturesReport& report) {
  DetectedFemur found = detected(surface.mesh, surface.file, report.side);
  report.landmarks = found.landmarks;
  report.side = found.side;
  report.notes = std::move(found.notes);
  if (!surface.note.empty()) report.notes.insert(report.notes.begin(), surface.note);
  override_landmarks(report.landmarks, surface.named);
}

void declare_features(Options& options, FeaturesArguments& arguments) {
  options.explain(closing_words);
  options.add("--mesh", arguments.mesh, "FILE", "A whole or a proximal femur, in mm: .stl .obj .ply .off .vtp .vtk");
  options.add("--model", arguments.model, "FILE", "A model of a femur, in mm, instead: its surface is meshed");
  options.add("--deviation", arguments.deviation, parse_positive_length, "MM",
              "How closely --model is meshed, by estimate (default 0.3)");
  options.add("--side", arguments.side, choice<Side>({{"left", Side::left}, {"right", Side::right}}), "SIDE",
              "left or right; a whole femur's mesh tells it. Version and frame need it");
  options.add("--landmarks", arguments.landmarks, "FILE", "Landmarks by hand, verisq-landmarks/1: .json");
  options.add("--landmark-radius", arguments.landmark_radius, parse_length, "MM",
              "How well landmarks are known: each lies within this of where it is given (default 0)");
  options.add("--implant", arguments.implant, "FILE", "An implant in its place: a model in the bone's coordinates");
  options.add("--head", arguments.implant_head, "NAME",
              "Its primitive that is the head (default: what its file names, else head)");
  options.add("--neck", arguments.implant_neck, "NAME",
              "Its primitive that is the neck (default: what its file names, else neck)");
  options.add("-o,--output", arguments.written_landmarks, "FILE",
              "Write the landmarks, to be corrected by hand: .json");
  options.add("--axes", arguments.axes, "FILE", "Write the head's sphere and the axes as a model: .json");
  declare_report_files(options, arguments.report);
  options.add("--certificate-file", arguments.certificate_file, "FILE",
              "Landmarks, and what is claimed of them, for `verisq check --certificate`: .json");
  add_device(options, arguments.device);
  add_json(options, arguments.json);
  add_no_progress(options, arguments.no_progress);
}

/// Throws Error(input) for whatever the user can correct.
ExitStatus run_features(const FeaturesArguments& arguments) {
  check_usage(arguments);
  std::optional<LandmarkFile> given;
  if (!arguments.landmarks.empty()) given = read_landmarks(arguments.landmarks);
  std::optional<Surface> surface;
  if (!arguments.mesh.empty()) surface = Surface{arguments.mesh, read_mesh(arguments.mesh)};
  std::optional<Implant> implant;
  if (!arguments.implant.empty()) implant = read_implant(arguments);
  if (!arguments.model.empty()) {
    watch_for_interruption();
    surface = meshed(arguments);
    if (!surface) return ExitStatus::interrupted;
  }

  FeaturesReport report{
      .landmarks = {}, .side = side_of(arguments, given), .landmark_radius = arguments.landmark_radius};
  if (surface && !(given && has_all_of_a_proximal_femur(given->landmarks))) detect_landmarks(*surface, report);
  if (interrupted()) return ExitStatus::interrupted;
  if (given) override_landmarks(report.landmarks, given->landmarks);
  report.bone = femur_features(report.landmarks, report.side, arguments.landmark_radius);
  if (implant) {
    report.implant_notes = implant->notes;
    report.changes = implant_changes(report.landmarks, report.side, arguments.landmark_radius, implant->points);
  }

  if (!arguments.written_landmarks.empty())
    write_landmarks(arguments.written_landmarks, {report.landmarks, report.side});
  bool drawn = true;
  if (!arguments.axes.empty() || arguments.report.any()) {
    const Model axes = features::drawn_axes(report.landmarks);
    if (axes.primitives.empty()) refuse("the landmarks make no axis that could be drawn");
    if (!arguments.axes.empty()) write_model(arguments.axes, axes);
    if (arguments.report.any()) {
      watch_for_interruption();  // a mesh has nothing to lose before: Ctrl-C ends the program
      drawn = draw(arguments, surface->mesh, figure_of(axes, implant), report);
    }
  }
  if (!arguments.certificate_file.empty()) write_certificate(arguments, surface, implant, report);
  fmt::print("{}", arguments.json ? json(report) : readable(report));
  if (!drawn) return ExitStatus::interrupted;
  return says_all(report) ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace

Command features_command() {
  return command("features", "Enclose what a surgeon measures of a femur: head, offset, CCD, version", declare_features,
                 run_features);
}

}  // namespace verisq::command_line
