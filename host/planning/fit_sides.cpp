/// Asks for what the files do not tell.
#include "host/planning/fit_sides.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>
#include <verisq/mesh_topology.hpp>

#include "host/errors/refusal.hpp"

namespace verisq::planning {
namespace {

/// One part, whose inside is what the user means.
void check_parts(const FitRequest& request, std::size_t parts) {
  if (parts == 1) return;
  if (request.surface == FitSurface::bone) {
    refuse(
        fmt::format("--bone: {} has {} separate surfaces: give the one that the implant touches, a canal's as --cavity",
                    request.mesh_name, parts));
  }
  refuse(
      fmt::format("--cavity: {} has {} separate surfaces, and only one can be the cavity's", request.mesh_name, parts));
}

void check_facing(const FitRequest& request, const Mesh& mesh, bool closed) {
  if (faces_outward(mesh)) return;
  refuse(closed ? fmt::format("--bone: {}: its normals point inward, as those of a cavity: if it is none, turn them by "
                              "`verisq surface --mesh`",
                              request.mesh_name)
                : fmt::format("--bone: {}: closed over its rims it would hold what its normals point to, which is no "
                              "bone: give the whole bone",
                              request.mesh_name));
}

/// A closed surface whose normals point inward bounds what lies inside it: a cavity (the paper, section 4).
bool is_cavity(const FitRequest& request, const Mesh& mesh, const MeshTopology& topology) {
  if (request.surface) return request.surface == FitSurface::cavity;
  return topology.bounds_solid() && signed_volume(mesh) < 0.0;
}

void check_has_sides(const FitRequest& request, const Mesh& mesh, bool has_sides) {
  if (!has_sides && request.surface) {
    refuse(fmt::format("--{}: vertices alone have no sides: give a mesh with triangles, and --on triangles",
                       *request.surface == FitSurface::cavity ? "cavity" : "bone"));
  }
  if (!has_sides) {
    refuse(
        "vertices alone have no sides, and an implant beside the bone touches nothing: give a mesh with triangles, "
        "or --any-side");
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
       {std::pair("--crossing", &request.crossing), std::pair("--outside", &request.outside)}) {
    for (const std::string& name : *names) {
      const auto has_it = [&](const UncertainModel& implant) {
        return std::ranges::any_of(implant.primitives, [&](const auto& primitive) { return primitive.name == name; });
      };
      if (std::ranges::none_of(series, has_it)) refuse(fmt::format("{}: no primitive is named {}", option, name));
      if (surface == FitSurface::unsided) refuse(fmt::format("{} {}: not with --any-side", option, name));
      if (is_named(request.crossing, name) && is_named(request.outside, name))
        refuse(fmt::format("--crossing {}: has to lie outside, by --outside", name));
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
                    "Give --cavity or --bone (or --any-side)",
                    request.mesh_name));
  }
  check_parts(request, topology.components);
  if (!request.surface)
    notices.push_back(fmt::format("{}: taken for a cavity, as its normals point inward", request.mesh_name));
  if (!cavity) check_facing(request, mesh, topology.closed());
  return cavity ? FitSurface::cavity : FitSurface::bone;
}

namespace {

/// What only cuts a solid lies anywhere.
void refuse_sides_of_cuts(const FitRequest& request, const UncertainModel& implant,
                          const std::vector<SurfaceSide>& sides) {
  for (std::size_t k = 0; k < sides.size(); ++k) {
    const std::string& name = implant.primitives[k].name;
    if (sides[k] == SurfaceSide::any && is_named(request.outside, name))
      refuse(fmt::format("--outside {}: only cuts the implant, so that it has no side", name));
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
      refuse("--crossing: names every primitive of an implant, so that none has to lie anywhere: give --any-side");
  }
  return sides;
}

void check_openings(const FitRequest& request, const Mesh& mesh) {
  if (request.crossing.empty() || !mesh_topology(mesh).closed()) return;
  refuse(fmt::format("--crossing {}: {} is closed: say by --resection where it is cut open", request.crossing.front(),
                     request.mesh_name));
}

}  // namespace verisq::planning
