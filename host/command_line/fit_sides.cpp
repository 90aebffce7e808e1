/// Asks for what the files do not tell.
#include "host/command_line/fit_sides.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <string>
#include <utility>
#include <verisq/error.hpp>
#include <verisq/mesh_topology.hpp>

#include "host/command_line/messages.hpp"
#include "host/command_line/refusal.hpp"

namespace verisq::command_line {
namespace {

/// One part, whose inside is what the user means.
void check_parts(const FitArguments& arguments, std::size_t parts) {
  if (parts == 1) return;
  if (arguments.bone) {
    refuse(
        fmt::format("--bone: {} has {} separate surfaces: give the one that the implant touches, a canal's as --cavity",
                    arguments.mesh, parts));
  }
  refuse(fmt::format("--cavity: {} has {} separate surfaces, and only one can be the cavity's", arguments.mesh, parts));
}

void check_facing(const FitArguments& arguments, const Mesh& mesh, bool closed) {
  if (faces_outward(mesh)) return;
  refuse(closed ? fmt::format("--bone: {}: its normals point inward, as those of a cavity: if it is none, turn them by "
                              "`verisq surface --mesh`",
                              arguments.mesh)
                : fmt::format("--bone: {}: closed over its rims it would hold what its normals point to, which is no "
                              "bone: give the whole bone",
                              arguments.mesh));
}

/// A closed surface whose normals point inward bounds what lies inside it: a cavity (the paper, section 4).
bool is_cavity(const FitArguments& arguments, const Mesh& mesh, const MeshTopology& topology) {
  if (arguments.cavity) return true;
  return !arguments.bone && topology.bounds_solid() && signed_volume(mesh) < 0.0;
}

void check_has_sides(const FitArguments& arguments, const Mesh& mesh, bool has_sides) {
  if (!has_sides && (arguments.cavity || arguments.bone)) {
    refuse(fmt::format("--{}: vertices alone have no sides: give a mesh with triangles, and --on triangles",
                       arguments.cavity ? "cavity" : "bone"));
  }
  if (!has_sides) {
    refuse(
        "vertices alone have no sides, and an implant beside the bone touches nothing: give a mesh with triangles, "
        "or --any-side");
  }
  try {
    check_surface_has_sides(mesh);
  } catch (const Error& error) {
    refuse(fmt::format("{}: {}: mend it by `verisq surface`, or give --any-side", arguments.mesh, error.what()));
  }
}

bool is_named(const std::vector<std::string>& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

void refuse_unknown_parts(const FitArguments& arguments, std::span<const UncertainModel> series, Surface surface) {
  for (const auto& [option, names] :
       {std::pair("--crossing", &arguments.crossing), std::pair("--outside", &arguments.outside)}) {
    for (const std::string& name : *names) {
      const auto has_it = [&](const UncertainModel& implant) {
        return std::ranges::any_of(implant.primitives, [&](const auto& primitive) { return primitive.name == name; });
      };
      if (std::ranges::none_of(series, has_it)) refuse(fmt::format("{}: no primitive is named {}", option, name));
      if (surface == Surface::unsided) refuse(fmt::format("{} {}: not with --any-side", option, name));
      if (is_named(arguments.crossing, name) && is_named(arguments.outside, name))
        refuse(fmt::format("--crossing {}: has to lie outside, by --outside", name));
    }
  }
}

}  // namespace

Surface surface_of(const FitArguments& arguments, const Mesh& mesh, bool has_sides) {
  const std::array given{arguments.cavity, arguments.bone, arguments.any_side};
  if (std::ranges::count(given, true) > 1) refuse("give only one of --cavity, --bone and --any-side");
  if (arguments.any_side) return Surface::unsided;
  check_has_sides(arguments, mesh, has_sides);
  const MeshTopology topology = mesh_topology(mesh);
  const bool cavity = is_cavity(arguments, mesh, topology);
  if (!cavity && !arguments.bone) {
    refuse(
        fmt::format("{}: is it a cavity, which the implant lies in, or bone, which it lies outside of? "
                    "Give --cavity or --bone (or --any-side)",
                    arguments.mesh));
  }
  check_parts(arguments, topology.components);
  if (cavity && !arguments.cavity)
    tell(fmt::format("{}: taken for a cavity, as its normals point inward", arguments.mesh));
  if (!cavity) check_facing(arguments, mesh, topology.closed());
  return cavity ? Surface::cavity : Surface::bone;
}

std::vector<std::vector<SurfaceSide>> sides_of(const FitArguments& arguments, std::span<const UncertainModel> series,
                                               Surface surface) {
  refuse_unknown_parts(arguments, series, surface);
  if (surface == Surface::unsided) return {};
  const SurfaceSide all = surface == Surface::cavity ? SurfaceSide::inside : SurfaceSide::outside;
  std::vector<std::vector<SurfaceSide>> sides;
  for (const UncertainModel& implant : series) {
    std::vector<SurfaceSide>& of_implant = sides.emplace_back();
    for (const UncertainPrimitive& primitive : implant.primitives) {
      const bool crossing = is_named(arguments.crossing, primitive.name);
      const bool outside = is_named(arguments.outside, primitive.name);
      of_implant.push_back(crossing ? SurfaceSide::any : (outside ? SurfaceSide::outside : all));
    }
    if (std::ranges::count(of_implant, SurfaceSide::any) == std::ssize(of_implant))
      refuse("--crossing: names every primitive of an implant, so that none has to lie anywhere: give --any-side");
  }
  return sides;
}

void check_openings(const FitArguments& arguments, const Mesh& mesh) {
  if (arguments.crossing.empty() || !mesh_topology(mesh).closed()) return;
  refuse(fmt::format("--crossing {}: {} is closed: say by --resection where it is cut open", arguments.crossing.front(),
                     arguments.mesh));
}

}  // namespace verisq::command_line
