/// This file implements fit_problem.hpp.
#include "host/plan/fit_problem.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>
#include <verisq/distance.hpp>
#include <verisq/fit_solution.hpp>
#include <verisq/mesh_topology.hpp>

#include "host/errors/refusal.hpp"
#include "host/plan/clearance.hpp"
#include "host/prepare/femur_axes.hpp"
#include "host/prepare/mesh_geometry.hpp"
#include "verify/solids/model.hpp"

namespace verisq {
namespace {

/// The range of an unknown change: broken, and finite for the search.
constexpr Enclosure unknown_change{-1e9, 1e9};

const Feature* feature_of(const FemurFeatures& changes, const std::string& name) {
  const auto found = std::ranges::find(changes.features, name, &Feature::name);
  return found == changes.features.end() ? nullptr : &*found;
}

}  // namespace

FemurFeatures changes_of(const FitProblem& problem, std::size_t implant, const Pose& pose) {
  if (!problem.bone) return {};
  return implant_changes(problem.bone->points, problem.bone->side, problem.bone->radius,
                         posed(problem.implant_landmarks[implant], pose));
}

std::optional<bool> is_within(const Enclosure& value, const Enclosure& range) {
  if (value.lo >= range.lo && value.hi <= range.hi) return true;
  if (value.hi < range.lo || value.lo > range.hi) return false;
  return std::nullopt;
}

bool is_preserved(const FemurFeatures& changes, std::span<const KeptFeature> kept) {
  return std::ranges::all_of(kept, [&](const KeptFeature& each) {
    const Feature* const change = feature_of(changes, each.name);
    return change != nullptr && is_within(change->value, each.range) == true;
  });
}

namespace planning {

/// Whatever the pose is, the same landmarks are there.
void check_kept(const FitProblem& problem) {
  if (!problem.bone) {
    if (!problem.kept.empty()) refuse("`keep`: needs `landmarks`, the bone's");
    return;
  }
  for (std::size_t i = 0; i < problem.series.size(); ++i) {
    const FemurFeatures changes = changes_of(problem, i, problem.options.range.start);
    for (const KeptFeature& kept : problem.kept) {
      if (feature_of(changes, kept.name) != nullptr) continue;
      std::vector<std::string> known;
      for (const Feature& feature : changes.features) known.push_back(feature.name);
      const std::string why = changes.missing.empty() ? "" : fmt::format(" ({})", fmt::join(changes.missing, "; "));
      refuse(fmt::format("`keep` {}: {} and {} say nothing of it; known are {}{}", on_one_line(kept.name),
                         problem.bone->name, problem.names[i],
                         known.empty() ? "none" : fmt::format("{}", fmt::join(known, ", ")), why));
    }
  }
}

std::vector<FitConstraint> constraints_of(const FitProblem& problem) {
  std::vector<FitConstraint> constraints;
  for (const KeptFeature& kept : problem.kept) {
    const auto value = [&problem, name = kept.name](std::size_t implant, const Pose& pose) {
      const FemurFeatures changes = changes_of(problem, implant, pose);
      const Feature* const feature = feature_of(changes, name);
      return feature == nullptr ? unknown_change : feature->value;
    };
    constraints.push_back({.name = kept.name, .range = kept.range, .unit = 1.0, .value = value});
  }
  return constraints;
}

}  // namespace planning
}  // namespace verisq

namespace verisq::planning {
namespace {

/// Requires a single part, whose inside the user means.
void check_parts(const FitRequest& request, std::size_t parts) {
  if (parts == 1) return;
  if (request.surface == FitSurface::bone) {
    refuse(
        fmt::format("`bone`: {} has {} separate surfaces: give the one that the implant touches, a canal's as `cavity`",
                    request.mesh_name, parts));
  }
  refuse(
      fmt::format("`cavity`: {} has {} separate surfaces, and only one can be the cavity's", request.mesh_name, parts));
}

void check_facing(const FitRequest& request, const Mesh& mesh, bool closed) {
  const std::optional<int> facing = facing_of(mesh);
  if (facing == 1) return;
  if (!facing) {
    refuse(fmt::format("`bone`: {}: encloses nothing, as far as can be proven: no bone lies in it", request.mesh_name));
  }
  refuse(closed ? fmt::format("`bone`: {}: its normals point inward, as those of a cavity: if it is none, turn them by "
                              "`verisq surface --mesh`",
                              request.mesh_name)
                : fmt::format("`bone`: {}: closed over its rims it would hold what its normals point to, which is no "
                              "bone: give the whole bone",
                              request.mesh_name));
}

/// A closed surface whose normals point inward bounds a cavity (the paper, section 4).
bool is_cavity(const FitRequest& request, const Mesh& mesh, const MeshTopology& topology) {
  if (request.surface) return request.surface == FitSurface::cavity;
  return topology.bounds_solid() && volume_sign(mesh) < 0;
}

void check_has_sides(const FitRequest& request, const Mesh& mesh, bool has_sides) {
  if (!has_sides && request.surface) {
    refuse(fmt::format("`{}`: vertices alone have no sides: give a mesh with triangles, and `on` triangles",
                       *request.surface == FitSurface::cavity ? "cavity" : "bone"));
  }
  if (!has_sides) {
    refuse(
        "vertices alone have no sides, and an implant beside the bone touches nothing: give a mesh with triangles, "
        "or `any_side`");
  }
  try {
    check_surface_has_sides(mesh);
  } catch (const Error& error) {
    refuse(fmt::format("{}: {}: mend it by `verisq surface`, or give --any-side", request.mesh_name, error.what()));
  }
}

bool is_named(const std::vector<std::string>& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

void refuse_unknown_parts(const FitRequest& request, std::span<const UncertainModel> series, FitSurface surface) {
  for (const auto& [option, names] :
       {std::pair("`crossing`", &request.crossing), std::pair("`outside`", &request.outside)}) {
    for (const std::string& name : *names) {
      const auto has_it = [&](const UncertainModel& implant) {
        return std::ranges::any_of(implant.primitives, [&](const auto& primitive) { return primitive.name == name; });
      };
      if (std::ranges::none_of(series, has_it)) refuse(fmt::format("{}: no primitive is named {}", option, name));
      if (surface == FitSurface::unsided) refuse(fmt::format("{} {}: not with `any_side`", option, name));
      if (is_named(request.crossing, name) && is_named(request.outside, name))
        refuse(fmt::format("`crossing` {}: has to lie outside, by `outside`", name));
    }
  }
}

}  // namespace

FitSurface surface_of(const FitRequest& request, const Mesh& mesh, bool has_sides, std::vector<std::string>& notices) {
  if (request.surface == FitSurface::unsided) return FitSurface::unsided;
  check_has_sides(request, mesh, has_sides);
  const MeshTopology topology = mesh_topology(mesh);
  const bool cavity = is_cavity(request, mesh, topology);
  if (!cavity && !request.surface) {
    refuse(
        fmt::format("{}: is it a cavity, which the implant lies in, or bone, which it lies outside of? "
                    "Give `cavity` or `bone` (or `any_side`)",
                    request.mesh_name));
  }
  check_parts(request, topology.components);
  if (!request.surface)
    notices.push_back(fmt::format("{}: taken for a cavity, as its normals point inward", request.mesh_name));
  if (!cavity) check_facing(request, mesh, topology.closed());
  return cavity ? FitSurface::cavity : FitSurface::bone;
}

namespace {

/// Primitives that only cut a solid lie anywhere.
void refuse_sides_of_cuts(const FitRequest& request, const UncertainModel& implant,
                          const std::vector<SurfaceSide>& sides) {
  for (std::size_t k = 0; k < sides.size(); ++k) {
    const std::string& name = implant.primitives[k].name;
    if (sides[k] == SurfaceSide::any && is_named(request.outside, name))
      refuse(fmt::format("`outside` {}: only cuts the implant, so that it has no side", name));
  }
}

}  // namespace

std::vector<std::vector<SurfaceSide>> sides_of(const FitRequest& request, std::span<const UncertainModel> series,
                                               FitSurface surface) {
  refuse_unknown_parts(request, series, surface);
  if (surface == FitSurface::unsided) return {};
  const SurfaceSide all = surface == FitSurface::cavity ? SurfaceSide::inside : SurfaceSide::outside;
  std::vector<std::vector<SurfaceSide>> sides;
  for (const UncertainModel& implant : series) {
    std::vector<SurfaceSide>& of_implant = sides.emplace_back(implant.primitives.size(), SurfaceSide::any);
    for (const std::uint32_t k : covering_primitives(bracket(implant).largest)) {
      const std::string& name = implant.primitives[k].name;
      if (is_named(request.crossing, name)) continue;
      of_implant[k] = is_named(request.outside, name) ? SurfaceSide::outside : all;
    }
    refuse_sides_of_cuts(request, implant, of_implant);
    if (std::ranges::count(of_implant, SurfaceSide::any) == std::ssize(of_implant))
      refuse("`crossing`: names every primitive of an implant, so that none has to lie anywhere: give `any_side`");
  }
  return sides;
}

void check_openings(const FitRequest& request, const Mesh& mesh) {
  if (request.crossing.empty() || !mesh_topology(mesh).closed()) return;
  refuse(fmt::format("`crossing` {}: {} is closed: say by `resection` where it is cut open", request.crossing.front(),
                     request.mesh_name));
}

}  // namespace verisq::planning

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
    refuse(fmt::format("{}: primitive {}: only semi-axes may be intervals, which are sizes to choose from", name,
                       quotation(primitive.name)));
  }
}

/// Refuses, before the search, what is not known of implants that are meshes.
void check_meshes(const FitRequest& request, const FitImplant& implant) {
  const Model model = bracket(implant.model).largest;
  if (!has_mesh(model)) return;
  if (!verify::is_union(model))
    refuse(fmt::format("{}: `csg` with meshes: only their union can be fitted: cut the mesh first", implant.name));
  if (request.device != "auto" && request.device != "host")
    refuse(
        fmt::format("`device` {}: {} has a mesh, which only the host fits: give host", request.device, implant.name));
  const bool keeps_contact = std::ranges::any_of(
      request.kept, [](const KeptFeature& kept) { return planning::is_contact_of_implant(kept.name); });
  if (request.implant_contact || keeps_contact)
    refuse(fmt::format("`implant_contact`: {} has a mesh, and it is known of superquadrics alone: give `keep` contact",
                       implant.name));
}

/// Sizes in a series can be compared only in one unit.
std::string common_units(std::span<const FitImplant> implants) {
  const auto first = std::ranges::find_if(implants, [](const FitImplant& each) { return !each.model.units.empty(); });
  if (first == implants.end()) return {};
  for (const FitImplant& implant : implants) {
    const std::string& units = implant.model.units;
    if (units.empty() || units == first->model.units) continue;
    refuse(fmt::format("{}: units {} differ from {} of {}", implant.name, quotation(units),
                       quotation(first->model.units), first->name));
  }
  return first->model.units;
}

Fitness fitness_of(const FitRequest& request, const std::string& units) {
  if (!request.gap && units != "mm") {
    refuse(fmt::format("`gap`: give one, because the implants' units are {}, not mm",
                       units.empty() ? "unknown" : quotation(units)));
  }
  const double gap = request.gap.value_or(default_gap_in_mm);
  if (request.completion == Completion::cementless) {
    if (request.gap_tolerance) refuse("`gap_tolerance`: only for `completion` cemented");
    if (gap == 0.0) refuse("`gap`: 0 is not above 0");
    return cementless(gap, request.penetration_limit);
  }
  if (request.gap_tolerance) return cemented(gap, *request.gap_tolerance);
  if (gap == 0.0) refuse("`gap_tolerance`: give one, because `gap` is 0");
  return cemented(gap, gap / 2.0);
}

PoseRange range_of(const FitRequest& request, const Mesh& mesh) {
  const PoseRange range{
      .start = request.pose_start,
      .translation = request.translation_range ? *request.translation_range : extent_of(mesh.vertices).half_diagonal(),
      .rotation_degrees = request.rotation_range};
  if (!std::isfinite(range.translation))
    refuse("`translation_range`: give one, because the size of the mesh overflows");
  return range;
}

void refuse_second_weights(const std::vector<Area>& weights) {
  for (auto weight = weights.begin(); weight != weights.end(); ++weight) {
    const bool fresh =
        std::none_of(weights.begin(), weight, [&](const Area& other) { return other.name == weight->name; });
    if (!fresh) refuse(fmt::format("`weight`: {} has two", weight->name));
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
      refuse(fmt::format("`weight`: no area has the name {}", quotation(weight.name)));
    }
  }
  return cavity(mesh.vertices, boxes, weight_elsewhere);
}

bool limits_triangles(const FitRequest& request, const Mesh& mesh) {
  if (request.on_triangles == true && mesh.triangles.empty())
    refuse(fmt::format("`on` triangles: {}: has none", request.mesh_name));
  return request.on_triangles != false && !mesh.triangles.empty();
}

CutMesh cut_mesh(FitRequest& request) {
  if (request.resection) {
    const bool has_triangles = !request.mesh.triangles.empty();
    CutMesh cut = cut_off(request.mesh, scaled(*request.resection));
    if (cut.mesh.vertices.empty() || (cut.mesh.triangles.empty() && has_triangles))
      refuse(fmt::format("`resection`: all of {} lies beyond it", request.mesh_name));
    return cut;
  }
  CutMesh whole{std::move(request.mesh), {}};
  whole.origin.resize(whole.mesh.vertices.size());
  std::iota(whole.origin.begin(), whole.origin.end(), 0U);
  return whole;
}

/// New vertices, at the resection, belong to the area of the vertex from which they were made.
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
  if (std::ranges::none_of(cavity.area_of, counts)) refuse("`weight`: every vertex has weight 0: nothing to fit");
  if (limits_triangles(request, mesh)) cavity.triangles = mesh.triangles;
  return cavity;
}

void tell_of_empty_areas(const Cavity& cavity, std::vector<std::string>& notices) {
  std::vector<bool> used(cavity.areas.size());
  for (const std::uint32_t area : cavity.area_of) used[area] = true;
  for (std::size_t k = 0; k < used.size(); ++k) {
    if (!used[k]) notices.push_back(fmt::format("area {}: has no vertex of the mesh", quotation(cavity.areas[k].name)));
  }
}

/// The landmarks of the implant that count for changes of the bone, if these are requested. Precondition:
/// check_implant.
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
    check_meshes(request, implant);
    problem.names.push_back(implant.name);
    problem.series.push_back(implant.model);
    problem.implant_landmarks.push_back(landmarks_of(implant, problem));
  }
  problem.units = common_units(request.implants);
  if (problem.bone && !problem.units.empty() && problem.units != "mm")
    refuse(fmt::format("`landmarks`: are in mm, the implants in {}", quotation(problem.units)));
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
