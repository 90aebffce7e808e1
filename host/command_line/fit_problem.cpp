/// Checks options against each other and against the files.
#include "host/command_line/fit_problem.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string_view>
#include <utility>
#include <verisq/landmark_file.hpp>
#include <verisq/mesh_file.hpp>
#include <verisq/model_file.hpp>

#include "host/command_line/fit_constraints.hpp"
#include "host/command_line/fit_sides.hpp"
#include "host/command_line/refusal.hpp"
#include "host/mesh/extent.hpp"

namespace verisq::command_line {
namespace {

constexpr std::string_view elsewhere = "elsewhere";  // the area of points that no box holds
constexpr double default_gap_in_mm = 2.0;
constexpr double relative_surface_tolerance = 2e-4;  // of the scale on which the fitness changes: nothing is lost

bool is_single(const Enclosure& number) {
  return number.lo == number.hi;
}

/// The library refuses the same without naming the file.
void check_implant(const UncertainModel& implant, const std::string& file) {
  if (!is_union_of_convex(bracket(implant).largest)) {
    refuse(
        fmt::format("{}: a fit does not support bends, nor csg other than the union of all primitives: make a union of "
                    "tapered ones of it, by `verisq mesh` and `verisq recover --primitives N --taper`",
                    file));
  }
  for (const UncertainPrimitive& primitive : implant.primitives) {
    if (std::ranges::all_of(primitive.exponents, is_single) && std::ranges::all_of(primitive.translation, is_single)) {
      continue;
    }
    refuse(fmt::format("{}: primitive \"{}\": only semi-axes may be intervals, which are sizes to choose from", file,
                       primitive.name));
  }
}

std::vector<UncertainModel> read_series(const std::vector<std::string>& files) {
  std::vector<UncertainModel> series;
  for (const std::string& file : files) {
    series.push_back(read_uncertain_model(file));
    check_implant(series.back(), file);
  }
  return series;
}

/// Sizes in a series can be compared only in one unit.
std::string common_units(const std::vector<UncertainModel>& series, const std::vector<std::string>& files) {
  const auto first = std::ranges::find_if(series, [](const UncertainModel& m) { return !m.units.empty(); });
  if (first == series.end()) return {};
  for (std::size_t k = 0; k < series.size(); ++k) {
    if (series[k].units.empty() || series[k].units == first->units) continue;
    refuse(fmt::format("{}: units {} differ from {} of {}", files[k], series[k].units, first->units,
                       files[static_cast<std::size_t>(first - series.begin())]));
  }
  return first->units;
}

Fitness fitness_of(const FitArguments& arguments, const std::string& units) {
  if (!arguments.gap && units != "mm") {
    refuse(
        fmt::format("--gap: give one, because the implants' units are {}, not mm", units.empty() ? "unknown" : units));
  }
  const double gap = arguments.gap.value_or(default_gap_in_mm);
  if (arguments.completion == Completion::cementless) {
    if (arguments.gap_tolerance) refuse("--gap-tolerance: only for --completion cemented");
    if (gap == 0.0) refuse("--gap: 0 is not above 0");
    return cementless(gap, arguments.penetration_limit);
  }
  if (arguments.gap_tolerance) return cemented(gap, *arguments.gap_tolerance);
  if (gap == 0.0) refuse("--gap-tolerance: give one, because --gap is 0");
  return cemented(gap, gap / 2.0);
}

PoseRange range_of(const FitArguments& arguments, const Mesh& mesh) {
  const PoseRange range{.start = arguments.pose_start.value_or(Pose{}),
                        .translation = arguments.translation_range ? *arguments.translation_range
                                                                   : extent_of(mesh.vertices).half_diagonal(),
                        .rotation_degrees = arguments.rotation_range};
  if (!std::isfinite(range.translation))
    refuse("--translation-range: give one, because the size of the mesh overflows");
  return range;
}

void refuse_second_weights(const std::vector<Area>& weights) {
  for (auto weight = weights.begin(); weight != weights.end(); ++weight) {
    const bool fresh =
        std::none_of(weights.begin(), weight, [&](const Area& other) { return other.name == weight->name; });
    if (!fresh) refuse(fmt::format("--weight: {} has two", weight->name));
  }
}

/// Areas are those of the bone: implants of a series may repeat them, but not contradict each other.
std::vector<AreaBox> read_common_areas(const std::vector<std::string>& files) {
  std::vector<AreaBox> common;
  std::string_view from;
  for (const std::string& file : files) {
    std::vector<AreaBox> areas = read_areas(file);
    if (areas.empty()) continue;
    if (!from.empty() && areas != common) refuse(fmt::format("{}: areas: differ from those of {}", file, from));
    common = std::move(areas);
    from = file;
  }
  return common;
}

/// The areas of the model files, whose weights the options may replace.
Cavity cavity_of_boxes(const FitArguments& arguments, const Mesh& mesh) {
  std::vector<AreaBox> boxes = read_common_areas(arguments.implants);
  double weight_elsewhere = 1.0;
  for (const Area& weight : arguments.weights) {
    const auto box =
        std::ranges::find(boxes, weight.name, [](const AreaBox& b) -> const std::string& { return b.area.name; });
    if (box != boxes.end()) {
      box->area.weight = weight.weight;
    } else if (weight.name == elsewhere) {
      weight_elsewhere = weight.weight;
    } else {
      refuse(fmt::format("--weight: no area has the name {}", weight.name));
    }
  }
  return cavity(mesh.vertices, boxes, weight_elsewhere);
}

bool limits_triangles(const FitArguments& arguments, const Mesh& mesh) {
  if (arguments.on == MapElements::triangles && mesh.triangles.empty())
    refuse(fmt::format("--on triangles: {}: has none", arguments.mesh));
  return arguments.on != MapElements::vertices && !mesh.triangles.empty();
}

CutMesh read_cut_mesh(const FitArguments& arguments) {
  Mesh mesh = read_mesh(arguments.mesh);
  if (arguments.resection) {
    const bool has_triangles = !mesh.triangles.empty();
    CutMesh cut = cut_off(mesh, *arguments.resection);
    if (cut.mesh.vertices.empty() || (cut.mesh.triangles.empty() && has_triangles))
      refuse(fmt::format("--resection: all of {} lies beyond it", arguments.mesh));
    return cut;
  }
  CutMesh whole{std::move(mesh), {}};
  whole.origin.resize(whole.mesh.vertices.size());
  std::iota(whole.origin.begin(), whole.origin.end(), 0U);
  return whole;
}

/// New vertices, at the resection, are of the area of the vertex that they were made of.
Cavity labelled_cavity(const FitArguments& arguments, const CutMesh& cut) {
  Cavity cavity = read_labelled_cavity(arguments.mesh, *arguments.labels, arguments.weights);
  std::vector<std::uint32_t> area_of;
  area_of.reserve(cut.origin.size());
  for (const std::uint32_t vertex : cut.origin) area_of.push_back(cavity.area_of[vertex]);
  cavity.points = cut.mesh.vertices;
  cavity.area_of = std::move(area_of);
  return cavity;
}

Cavity read_cavity(const FitArguments& arguments, const CutMesh& cut) {
  const Mesh& mesh = cut.mesh;
  Cavity cavity = arguments.labels ? labelled_cavity(arguments, cut) : cavity_of_boxes(arguments, mesh);
  const auto counts = [&](std::uint32_t area) { return cavity.areas[area].weight > 0.0; };
  if (std::ranges::none_of(cavity.area_of, counts)) refuse("--weight: every vertex has weight 0: nothing to fit");
  if (limits_triangles(arguments, mesh)) cavity.triangles = mesh.triangles;
  return cavity;
}

}  // namespace

FitProblem read_fit_problem(const FitArguments& arguments) {
  refuse_second_weights(arguments.weights);
  FitProblem problem{.series = read_series(arguments.implants),
                     .landmarks = {},
                     .units = {},
                     .mesh = {},
                     .bone = {},
                     .cavity = {},
                     .options = {.fitness = {}, .penetration_limit = arguments.penetration_limit, .range = {}}};
  for (const std::string& file : arguments.implants) problem.landmarks.push_back(read_model_landmarks(file));
  problem.units = common_units(problem.series, arguments.implants);
  if (!arguments.landmarks.empty()) {
    if (!problem.units.empty() && problem.units != "mm")
      refuse(fmt::format("--landmarks: are in mm, the implants in {}", problem.units));
    problem.bone = read_landmarks(arguments.landmarks);
  }
  check_kept(arguments, problem);
  problem.options.fitness = fitness_of(arguments, problem.units);
  problem.options.surface_tolerance = relative_surface_tolerance * problem.options.fitness.scale;
  CutMesh cut = read_cut_mesh(arguments);
  problem.surface = surface_of(arguments, cut.mesh, limits_triangles(arguments, cut.mesh));
  problem.options.sides = sides_of(arguments, problem.series, problem.surface);
  check_openings(arguments, cut.mesh);
  problem.cavity = read_cavity(arguments, cut);
  problem.mesh = std::move(cut.mesh);
  problem.options.range = range_of(arguments, problem.mesh);
  problem.options.seed = arguments.seed;
  problem.options.samples = arguments.samples;
  problem.options.device = arguments.device;
  return problem;
}

}  // namespace verisq::command_line
