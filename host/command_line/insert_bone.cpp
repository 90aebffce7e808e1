/// A cavity says where bone begins, an outer surface or a resection where it ends.
#include "host/command_line/insert_bone.hpp"

#include <fmt/core.h>

#include <verisq/error.hpp>
#include <verisq/mesh_file.hpp>
#include <verisq/mesh_topology.hpp>
#include <verisq/sides.hpp>

#include "host/command_line/refusal.hpp"
#include "host/mesh/plane_cut.hpp"

namespace verisq::command_line {
namespace {

/// One closed or open surface that has two sides.
void check_surface(const std::string& option, const std::string& file, const Mesh& mesh) {
  try {
    check_surface_has_sides(mesh);
  } catch (const Error& error) {
    refuse(fmt::format("{}: {}: {}: mend it by `verisq surface`", option, file, error.what()));
  }
  const std::size_t parts = mesh_topology(mesh).components;
  if (parts > 1) refuse(fmt::format("{}: {} has {} separate surfaces, and only one can be meant", option, file, parts));
}

void check_outer_surface(const std::string& option, const std::string& file, const Mesh& mesh) {
  check_surface(option, file, mesh);
  if (!faces_outward(mesh)) refuse(fmt::format("{}: {}: its normals point inward, as a cavity's", option, file));
}

}  // namespace

void check_bone_options(const InsertArguments& arguments) {
  if (arguments.cavity && arguments.bone) refuse("give only one of --cavity and --bone");
  if (arguments.within && !arguments.cavity) refuse("--within: only with --cavity");
  if (arguments.volume_tolerance && !arguments.cavity && !arguments.bone)
    refuse("--volume-tol: nothing says where bone is: give --cavity or --bone");
  if (arguments.cavity && !arguments.within && !arguments.resection) {
    refuse(
        "--cavity: nothing says where the bone around it ends: give --within with the bone's outer surface, or "
        "--resection");
  }
}

Mesh before_resection(const InsertArguments& arguments, const Mesh& mesh) {
  if (!arguments.resection) return mesh;
  Mesh left = cut_off(mesh, *arguments.resection).mesh;
  if (left.vertices.empty()) refuse(fmt::format("--resection: all of {} lies beyond it", arguments.mesh));
  return left;
}

std::optional<BoneRegion> bone_region(const InsertArguments& arguments, const Mesh& mesh) {
  if (!arguments.cavity && !arguments.bone) return std::nullopt;
  BoneRegion region{.surfaces = {}, .resection = arguments.resection};
  if (arguments.cavity) {
    check_surface("--cavity", arguments.mesh, mesh);
    region.surfaces.push_back({mesh, BoneSide::outside});
  } else {
    check_outer_surface("--bone", arguments.mesh, mesh);
    region.surfaces.push_back({mesh, BoneSide::inside});
  }
  if (arguments.within) {
    Mesh outer = read_mesh(*arguments.within);
    check_outer_surface("--within", *arguments.within, outer);
    region.surfaces.push_back({std::move(outer), BoneSide::inside});
  }
  return region;
}

}  // namespace verisq::command_line
