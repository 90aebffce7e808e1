/// A cavity says where bone begins, an outer surface or a resection where it ends.
#include <fmt/core.h>

#include <utility>
#include <verisq/bone_region.hpp>
#include <verisq/mesh_topology.hpp>
#include <verisq/sides.hpp>

#include "host/errors/refusal.hpp"
#include "verify/containment/bone_around_cavity.hpp"
#include "verify/containment/rims.hpp"

namespace verisq {
namespace {

/// One closed or open surface that has two sides.
void check_surface_of_bone(const char* option, const NamedMesh& surface) {
  try {
    check_surface_has_sides(surface.mesh);
  } catch (const Error& error) {
    refuse(fmt::format("{}: {}: {}: mend it by `verisq surface`", option, surface.name, error.what()));
  }
  const std::size_t parts = mesh_topology(surface.mesh).components;
  if (parts > 1) {
    refuse(fmt::format("{}: {} has {} separate surfaces, and only one can be meant", option, surface.name, parts));
  }
}

void check_outer_surface(const char* option, const NamedMesh& surface) {
  check_surface_of_bone(option, surface);
  if (!faces_outward(surface.mesh))
    refuse(fmt::format("{}: {}: its normals point inward, as a cavity's", option, surface.name));
}

std::optional<Plane> scaled_if(const std::optional<Plane>& resection) {
  return resection ? std::optional(scaled(*resection)) : std::nullopt;
}

}  // namespace

BoneRegion bone_around(NamedMesh cavity, std::optional<NamedMesh> outer, const std::optional<Plane>& resection) {
  if (!outer && !resection) {
    refuse(
        "--cavity: nothing says where the bone around it ends: give --within with the bone's outer surface, or "
        "--resection");
  }
  check_surface_of_bone("--cavity", cavity);
  BoneRegion region{.surfaces = {}, .resection = scaled_if(resection)};
  region.surfaces.push_back({std::move(cavity.mesh), BoneSide::outside});
  if (!outer) return region;
  check_outer_surface("--within", *outer);
  const verify::ClosedSurface closed(verify::closed_triangles(outer->mesh, verify::closing_over_rims(outer->mesh)));
  region.surfaces.push_back({std::move(outer->mesh), BoneSide::inside});
  try {
    verify::require_cavities_in_bone(
        region, [&](std::size_t) -> const auto& { return closed; });
  } catch (const Error& error) {
    refuse(fmt::format("--within {}: {}", outer->name, error.what()));
  }
  return region;
}

BoneRegion bone_inside(NamedMesh outer, const std::optional<Plane>& resection) {
  check_outer_surface("--bone", outer);
  BoneRegion region{.surfaces = {}, .resection = scaled_if(resection)};
  region.surfaces.push_back({std::move(outer.mesh), BoneSide::inside});
  return region;
}

Mesh before_resection(const NamedMesh& mesh, const Plane& resection) {
  Mesh left = cut_off(mesh.mesh, scaled(resection)).mesh;
  if (left.vertices.empty()) refuse(fmt::format("--resection: all of {} lies beyond it", mesh.name));
  return left;
}

}  // namespace verisq
