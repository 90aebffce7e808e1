/// Checks what is asked of a fit, each thing against the others.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string_view>
#include <utility>
#include <verisq/fit_problem.hpp>

#include "host/errors/refusal.hpp"
#include "host/features/implant_points.hpp"
#include "host/mesh/extent.hpp"
#include "host/planning/fit_constraints.hpp"
#include "host/planning/fit_contacts.hpp"
#include "host/planning/fit_sides.hpp"

namespace verisq {
namespace {

constexpr std::string_view elsewhere_name = "elsewhere";  // the area of points that no box holds
constexpr double default_gap_in_mm = 2.0;
constexpr double relative_surface_tolerance = 2e-4;  // of the scale on which the fitness changes: nothing is lost

bool is_single(const Enclosure& number) {
  return number.lo == number.hi;
}

/// The library refuses the same without naming the file.
void check_implant(const UncertainModel& implant, const std::string& name) {
  if (!is_exact(implant) && !is_union_of_convex(bracket(implant).largest)) {
    refuse(fmt::format("{}: sizes to choose from are for unions of primitives without bends: give a file for each size",
                       name));
  }
  for (const UncertainPrimitive& primitive : implant.primitives) {
    if (std::ranges::all_of(primitive.exponents, is_single) && std::ranges::all_of(primitive.translation, is_single)) {
      continue;
    }
    refuse(fmt::format("{}: primitive \"{}\": only semi-axes may be intervals, which are sizes to choose from", name,
                       primitive.name));
  }
}

/// Sizes in a series can be compared only in one unit.
std::string common_units(std::span<const FitImplant> implants) {
  const auto first = std::ranges::find_if(implants, [](const FitImplant& each) { return !each.model.units.empty(); });
  if (first == implants.end()) return {};
  for (const FitImplant& implant : implants) {
    const std::string& units = implant.model.units;
    if (units.empty() || units == first->model.units) continue;
    refuse(fmt::format("{}: units {} differ from {} of {}", implant.name, units, first->model.units, first->name));
  }
  return first->model.units;
}

Fitness fitness_of(const FitRequest& request, const std::string& units) {
  if (!request.gap && units != "mm") {
    refuse(
        fmt::format("--gap: give one, because the implants' units are {}, not mm", units.empty() ? "unknown" : units));
  }
  const double gap = request.gap.value_or(default_gap_in_mm);
  if (request.completion == Completion::cementless) {
    if (request.gap_tolerance) refuse("--gap-tolerance: only for --completion cemented");
    if (gap == 0.0) refuse("--gap: 0 is not above 0");
    return cementless(gap, request.penetration_limit);
  }
  if (request.gap_tolerance) return cemented(gap, *request.gap_tolerance);
  if (gap == 0.0) refuse("--gap-tolerance: give one, because --gap is 0");
  return cemented(gap, gap / 2.0);
}

PoseRange range_of(const FitRequest& request, const Mesh& mesh) {
  const PoseRange range{
      .start = request.pose_start,
      .translation = request.translation_range ? *request.translation_range : extent_of(mesh.vertices).half_diagonal(),
      .rotation_degrees = request.rotation_range};
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
std::vector<AreaBox> common_areas(std::span<const FitImplant> implants) {
  const FitImplant* first = nullptr;
  for (const FitImplant& implant : implants) {
    if (implant.areas.empty()) continue;
    if (first != nullptr && implant.areas != first->areas)
      refuse(fmt::format("{}: areas: differ from those of {}", implant.name, first->name));
    first = &implant;
  }
  return first == nullptr ? std::vector<AreaBox>() : first->areas;
}

/// The boxes' areas, whose weights the request may replace.
Cavity cavity_of_boxes(const FitRequest& request, const Mesh& mesh) {
  std::vector<AreaBox> boxes = common_areas(request.implants);
  double weight_elsewhere = 1.0;
  for (const Area& weight : request.weights) {
    const auto box =
        std::ranges::find(boxes, weight.name, [](const AreaBox& b) -> const std::string& { return b.area.name; });
    if (box != boxes.end()) {
      box->area.weight = weight.weight;
    } else if (weight.name == elsewhere_name) {
      weight_elsewhere = weight.weight;
    } else {
      refuse(fmt::format("--weight: no area has the name {}", weight.name));
    }
  }
  return cavity(mesh.vertices, boxes, weight_elsewhere);
}

bool limits_triangles(const FitRequest& request, const Mesh& mesh) {
  if (request.on_triangles == true && mesh.triangles.empty())
    refuse(fmt::format("--on triangles: {}: has none", request.mesh_name));
  return request.on_triangles != false && !mesh.triangles.empty();
}

CutMesh cut_mesh(FitRequest& request) {
  if (request.resection) {
    const bool has_triangles = !request.mesh.triangles.empty();
    CutMesh cut = cut_off(request.mesh, scaled(*request.resection));
    if (cut.mesh.vertices.empty() || (cut.mesh.triangles.empty() && has_triangles))
      refuse(fmt::format("--resection: all of {} lies beyond it", request.mesh_name));
    return cut;
  }
  CutMesh whole{std::move(request.mesh), {}};
  whole.origin.resize(whole.mesh.vertices.size());
  std::iota(whole.origin.begin(), whole.origin.end(), 0U);
  return whole;
}

/// New vertices, at the resection, are of the area of the vertex that they were made of.
Cavity labelled_part(const Cavity& whole, const CutMesh& cut) {
  Cavity part{cut.mesh.vertices, whole.areas, {}};
  part.area_of.reserve(cut.origin.size());
  for (const std::uint32_t vertex : cut.origin) part.area_of.push_back(whole.area_of[vertex]);
  return part;
}

Cavity cavity_of(const FitRequest& request, const CutMesh& cut) {
  const Mesh& mesh = cut.mesh;
  Cavity cavity = request.labelled ? labelled_part(*request.labelled, cut) : cavity_of_boxes(request, mesh);
  const auto counts = [&](std::uint32_t area) { return cavity.areas[area].weight > 0.0; };
  if (std::ranges::none_of(cavity.area_of, counts)) refuse("--weight: every vertex has weight 0: nothing to fit");
  if (limits_triangles(request, mesh)) cavity.triangles = mesh.triangles;
  return cavity;
}

void tell_of_empty_areas(const Cavity& cavity, std::vector<std::string>& notices) {
  std::vector<bool> used(cavity.areas.size());
  for (const std::uint32_t area : cavity.area_of) used[area] = true;
  for (std::size_t k = 0; k < used.size(); ++k) {
    if (!used[k]) notices.push_back(fmt::format("area {}: has no vertex of the mesh", cavity.areas[k].name));
  }
}

/// Those that count for what the implant changes of the bone, where that is asked for. Precondition: check_implant.
FemurLandmarks landmarks_of(const FitImplant& implant, FitProblem& problem) {
  if (!problem.bone) return implant.landmarks;
  std::vector<features::NamedCentre> centres;
  for (const UncertainPrimitive& primitive : implant.model.primitives) {
    const auto& [x, y, z] = primitive.translation;
    centres.push_back({primitive.name, {x.lo, y.lo, z.lo}});
  }
  const auto [points, notes] = features::implant_points(implant.landmarks, centres);
  if (points == implant.landmarks && points.head_centre) return points;
  for (const std::string& note : notes) problem.notices.push_back(fmt::format("{}: {}", implant.name, note));
  if (!points.head_centre) {
    problem.notices.push_back(
        fmt::format("{}: names no landmark head_centre and has no primitive \"head\", of which it could be told what "
                    "happens to the head",
                    implant.name));
  }
  return points;
}

void check_labels(const FitRequest& request) {
  if (request.labelled && request.labelled->area_of.size() != request.mesh.vertices.size()) {
    refuse(fmt::format("{}: has {} vertices, of which {} have labels", request.mesh_name, request.mesh.vertices.size(),
                       request.labelled->area_of.size()));
  }
}

}  // namespace

FitProblem fit_problem(FitRequest request) {
  refuse_second_weights(request.weights);
  check_labels(request);
  FitProblem problem{.names = {},
                     .series = {},
                     .implant_landmarks = {},
                     .units = {},
                     .mesh = {},
                     .bone = request.landmarks,
                     .kept = {},
                     .contacts = {},
                     .implant_contact = request.implant_contact,
                     .cavity = {},
                     .options = {.fitness = {}, .penetration_limit = request.penetration_limit, .range = {}},
                     .notices = {}};
  for (const KeptFeature& kept : request.kept)
    (planning::is_contact(kept.name) ? problem.contacts : problem.kept).push_back(kept);
  for (const FitImplant& implant : request.implants) {
    check_implant(implant.model, implant.name);
    problem.names.push_back(implant.name);
    problem.series.push_back(implant.model);
    problem.implant_landmarks.push_back(landmarks_of(implant, problem));
  }
  problem.units = common_units(request.implants);
  if (problem.bone && !problem.units.empty() && problem.units != "mm")
    refuse(fmt::format("--landmarks: are in mm, the implants in {}", problem.units));
  problem.options.range.start = request.pose_start;
  planning::check_kept(problem);
  problem.options.fitness = fitness_of(request, problem.units);
  problem.options.surface_tolerance = relative_surface_tolerance * problem.options.fitness.scale;
  CutMesh cut = cut_mesh(request);
  problem.surface = planning::surface_of(request, cut.mesh, limits_triangles(request, cut.mesh), problem.notices);
  problem.options.sides = planning::sides_of(request, problem.series, problem.surface);
  planning::check_openings(request, cut.mesh);
  problem.cavity = cavity_of(request, cut);
  tell_of_empty_areas(problem.cavity, problem.notices);
  problem.mesh = std::move(cut.mesh);
  planning::check_contacts(problem);
  problem.options.objective = request.objective;
  problem.options.range = range_of(request, problem.mesh);
  problem.options.seed = request.seed;
  problem.options.samples = request.samples;
  problem.options.device = request.device;
  return problem;
}

}  // namespace verisq
