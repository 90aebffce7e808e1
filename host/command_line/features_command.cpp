/// Reads the options of `verisq features`, finds or reads landmarks, encloses what they say, draws the axes.
#include "host/command_line/features_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <verisq/certificate_file.hpp>
#include <verisq/error.hpp>
#include <verisq/landmark_file.hpp>
#include <verisq/map.hpp>
#include <verisq/mesh_file.hpp>
#include <verisq/model_file.hpp>
#include <verisq/model_mesh.hpp>

#include "host/command_line/certificate_output.hpp"
#include "host/command_line/choice.hpp"
#include "host/command_line/features_summary.hpp"
#include "host/command_line/interruption.hpp"
#include "host/command_line/length_option.hpp"
#include "host/command_line/messages.hpp"
#include "host/command_line/overwriting.hpp"
#include "host/command_line/shared_options.hpp"
#include "host/errors/refusal.hpp"
#include "host/features/drawn_axes.hpp"
#include "host/features/implant_points.hpp"

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

DetectedFemur detected(const Mesh& mesh, const std::string& file, const std::optional<Side>& side) {
  try {
    return detect_femur(mesh, side);
  } catch (const Error& error) {
    throw Error(error.kind(), fmt::format("{}: {}", file, error.what()));
  }
}

/// A bone's surface, and which file it is of.
struct Surface {
  std::string file;
  Mesh mesh;
  std::string note = {};  ///< how it was made, where it was
  FemurLandmarks named = {};
};

/// Nothing where it was interrupted.
std::optional<Surface> meshed(const FeaturesArguments& arguments) {
  const Model model = read_model(arguments.model);
  if (!model.units.empty() && model.units != "mm")
    refuse(fmt::format("{}: units {}: a femur is measured in mm", arguments.model, model.units));
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
    refuse(fmt::format("{}: {} has no primitive \"{}\"", option, arguments.implant, name));
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

/// Whether each feature whose landmarks are there is enclosed: known exactly, they would say no more of them.
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
  write_answer(arguments.certificate_file, answer);
}

}  // namespace

void declare_features(Options& options, FeaturesArguments& arguments) {
  options.explain(closing_words);
  options.add("--mesh", arguments.mesh, "FILE", "A whole or a proximal femur, in mm: .stl .obj .ply .off");
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
}

ExitStatus run_features(const FeaturesArguments& arguments) {
  check_usage(arguments);
  std::optional<LandmarkFile> given;
  if (!arguments.landmarks.empty()) given = read_landmarks(arguments.landmarks);
  std::optional<Surface> surface;
  if (!arguments.mesh.empty()) surface = Surface{arguments.mesh, read_mesh(arguments.mesh)};
  std::optional<Implant> implant;
  if (!arguments.implant.empty()) implant = read_implant(arguments);
  watch_for_interruption();
  if (!arguments.model.empty()) {
    surface = meshed(arguments);
    if (!surface) return ExitStatus::interrupted;
  }

  const std::optional<Side> side = side_of(arguments, given);
  FeaturesReport report{.landmarks = {}, .side = side, .landmark_radius = arguments.landmark_radius};
  if (surface && !(given && has_all_of_a_proximal_femur(given->landmarks))) {
    DetectedFemur found = detected(surface->mesh, surface->file, side);
    report.landmarks = found.landmarks;
    report.side = found.side;
    report.notes = std::move(found.notes);
    if (!surface->note.empty()) report.notes.insert(report.notes.begin(), surface->note);
    override_landmarks(report.landmarks, surface->named);
  }
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
    if (arguments.report.any()) drawn = draw(arguments, surface->mesh, figure_of(axes, implant), report);
  }
  if (!arguments.certificate_file.empty()) write_certificate(arguments, surface, implant, report);
  fmt::print("{}", arguments.json ? json(report) : readable(report));
  if (!drawn) return ExitStatus::interrupted;
  return says_all(report) ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace verisq::command_line
