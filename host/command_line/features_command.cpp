/// Reads the options of `verisq features`, finds or reads landmarks, encloses what they say, draws the axes.
#include "host/command_line/features_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <verisq/error.hpp>
#include <verisq/landmark_file.hpp>
#include <verisq/map.hpp>
#include <verisq/mesh_file.hpp>
#include <verisq/model_file.hpp>

#include "host/command_line/choice.hpp"
#include "host/command_line/features_summary.hpp"
#include "host/command_line/interruption.hpp"
#include "host/command_line/length_option.hpp"
#include "host/command_line/messages.hpp"
#include "host/command_line/overwriting.hpp"
#include "host/command_line/refusal.hpp"
#include "host/command_line/shared_options.hpp"
#include "host/features/drawn_axes.hpp"

namespace verisq::command_line {
namespace {

constexpr const char* closing_words =
    "Landmarks are found in floating point, in millimetres: look at them (--report). Those of --landmarks take the "
    "place\n"
    "of what was found; where they hold head, neck and shaft, nothing is sought. What is proven: each interval holds "
    "the\n"
    "feature for every choice of the landmarks within --landmark-radius of where they are. Methods of version differ "
    "by\n"
    "up to 18 degrees (Murphy), so that each is named. Angles of version are positive ahead.\n"
    "\n"
    "Of an implant in its place (--implant, as `verisq fit` writes it) the changes of offset, of leg length and of\n"
    "version follow, of the centres of its primitives --head and --neck.\n"
    "\n"
    "Exit status: 0 all features of the landmarks that are there; 3 some need landmarks that are known better, or the\n"
    "implant's or the bone's are missing for its changes; 2 bad usage or input, or no femur.\n"
    "\n"
    "Examples:\n"
    "  verisq features --mesh femur.stl --report features.html\n"
    "  verisq features --mesh femur.stl --landmark-radius 1 -o landmarks.json --json\n"
    "  verisq features --landmarks landmarks.json --implant fitted.json --landmark-radius 1";

void check_usage(const FeaturesArguments& arguments) {
  if (arguments.mesh.empty() && arguments.landmarks.empty()) refuse("give --mesh, --landmarks or both");
  const std::vector<std::string> inputs{arguments.mesh, arguments.landmarks, arguments.implant};
  if (arguments.report.any() && arguments.mesh.empty()) refuse("--report and --png: want a --mesh");
  check_usage(arguments.report, inputs);
  if (!arguments.written_landmarks.empty()) refuse_to_overwrite("-o", arguments.written_landmarks, inputs);
  if (!arguments.axes.empty()) refuse_to_overwrite("--axes", arguments.axes, inputs);
}

/// What is given takes the place of what was found.
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

/// Whether there is nothing that must be found: then a mesh is there to be drawn.
bool has_all_of_a_proximal_femur(const FemurLandmarks& landmarks) {
  return landmarks.head_centre && landmarks.head_radius && landmarks.neck_centre && landmarks.shaft_proximal &&
         landmarks.shaft_distal;
}

DetectedFemur detected(const Mesh& mesh, const FeaturesArguments& arguments, const std::optional<Side>& side) {
  try {
    return detect_femur(mesh, side);
  } catch (const Error& error) {
    throw Error(error.kind(), fmt::format("{}: {}", arguments.mesh, error.what()));
  }
}

const Primitive* primitive_of(const Model& model, const std::string& name) {
  const auto found = std::ranges::find(model.primitives, name, &Primitive::name);
  return found == model.primitives.end() ? nullptr : &*found;
}

FemurFeatures changes_by(const Model& implant, const FeaturesArguments& arguments, const FemurLandmarks& landmarks,
                         const std::optional<Side>& side) {
  const Primitive* const head = primitive_of(implant, arguments.implant_head);
  if (head == nullptr)
    refuse(fmt::format("--head: {} has no primitive \"{}\"", arguments.implant, arguments.implant_head));
  const Primitive* const neck = primitive_of(implant, arguments.implant_neck);
  std::optional<Point> neck_point;
  if (neck != nullptr) neck_point = neck->pose.translation;
  return implant_changes(landmarks, side, arguments.landmark_radius, head->pose.translation, neck_point);
}

/// Whether each feature whose landmarks are there is enclosed: known exactly, they would say no more of them.
bool says_all(const FeaturesReport& report) {
  const FemurFeatures exactly = femur_features(report.landmarks, report.side, 0.0);
  return report.bone.features.size() == exactly.features.size() &&
         report.bone.frame.has_value() == exactly.frame.has_value() &&
         (!report.changes || report.changes->missing.empty());
}

/// The bone with the axes in it, coloured by the distance to them. False where it was interrupted.
bool draw(const FeaturesArguments& arguments, const Mesh& mesh, const Model& axes, const FeaturesReport& report) {
  std::vector<MapResult> rows(mesh.vertices.size());
  const MapOptions options{.tolerance = 1e-6, .device = arguments.device, .interrupted = interrupted};
  const MapSummary summary = PointMapper(axes, options).map(mesh.vertices, rows);
  if (summary.interrupted) {
    tell("interrupted; report and picture are not written");
    return false;
  }
  write(arguments.report, {.title = "Features of a femur: the figure is its head and axes",
                           .bone = mesh,
                           .rows = rows,
                           .implant = axes,
                           .units = "mm",
                           .summary = report_lines(report),
                           .area_names = {},
                           .area_of = {},
                           .solid_name = "figure"});
  return true;
}

}  // namespace

void declare_features(Options& options, FeaturesArguments& arguments) {
  options.explain(closing_words);
  options.add("--mesh", arguments.mesh, "FILE", "A whole or a proximal femur, in mm: .stl .obj .ply .off");
  options.add("--side", arguments.side, choice<Side>({{"left", Side::left}, {"right", Side::right}}), "SIDE",
              "left or right; a whole femur's mesh tells it. Version and frame need it");
  options.add("--landmarks", arguments.landmarks, "FILE", "Landmarks by hand, verisq-landmarks/1: .json");
  options.add("--landmark-radius", arguments.landmark_radius, parse_length, "MM",
              "How well landmarks are known: each lies within this of where it is given (default 0)");
  options.add("--implant", arguments.implant, "FILE", "An implant in its place: a model in the bone's coordinates");
  options.add("--head", arguments.implant_head, "NAME", "The implant's primitive that is the head (default head)");
  options.add("--neck", arguments.implant_neck, "NAME", "The implant's primitive that is the neck (default neck)");
  options.add("-o,--output", arguments.written_landmarks, "FILE",
              "Write the landmarks, to be corrected by hand: .json");
  options.add("--axes", arguments.axes, "FILE", "Write the head's sphere and the axes as a model: .json");
  declare_report_files(options, arguments.report);
  add_device(options, arguments.device);
  add_json(options, arguments.json);
}

ExitStatus run_features(const FeaturesArguments& arguments) {
  check_usage(arguments);
  std::optional<LandmarkFile> given;
  if (!arguments.landmarks.empty()) given = read_landmarks(arguments.landmarks);
  std::optional<Mesh> mesh;
  if (!arguments.mesh.empty()) mesh = read_mesh(arguments.mesh);
  std::optional<Model> implant;
  if (!arguments.implant.empty()) implant = read_model(arguments.implant);
  watch_for_interruption();

  const std::optional<Side> side = side_of(arguments, given);
  FeaturesReport report{{}, side, arguments.landmark_radius, {}, {}, {}};
  if (mesh && !(given && has_all_of_a_proximal_femur(given->landmarks))) {
    DetectedFemur found = detected(*mesh, arguments, side);
    report.landmarks = found.landmarks;
    report.side = found.side;
    report.notes = std::move(found.notes);
  }
  if (given) override_landmarks(report.landmarks, given->landmarks);
  report.bone = femur_features(report.landmarks, report.side, arguments.landmark_radius);
  if (implant) report.changes = changes_by(*implant, arguments, report.landmarks, report.side);

  if (!arguments.written_landmarks.empty())
    write_landmarks(arguments.written_landmarks, {report.landmarks, report.side});
  bool drawn = true;
  if (!arguments.axes.empty() || arguments.report.any()) {
    const Model axes = features::drawn_axes(report.landmarks);
    if (axes.primitives.empty()) refuse("the landmarks make no axis that could be drawn");
    if (!arguments.axes.empty()) write_model(arguments.axes, axes);
    if (arguments.report.any()) drawn = draw(arguments, *mesh, axes, report);
  }
  fmt::print("{}", arguments.json ? json(report) : readable(report));
  if (!drawn) return ExitStatus::interrupted;
  return says_all(report) ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace verisq::command_line
