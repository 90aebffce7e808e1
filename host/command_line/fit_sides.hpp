/// On which side of the mesh an implant's parts have to be, from the options and the mesh itself.
#pragma once

#include <span>
#include <vector>
#include <verisq/mesh.hpp>
#include <verisq/sides.hpp>
#include <verisq/uncertain_model.hpp>

#include "host/command_line/fit_command.hpp"

namespace verisq::command_line {

/// What the mesh bounds; `has_sides` where its triangles keep the limit. Throws Error(input) where the user has to say,
/// and for a surface that is not what the user says.
[[nodiscard]] Surface surface_of(const FitArguments& arguments, const Mesh& mesh, bool has_sides);

/// One a primitive for each implant; none where the surface is unsided. Throws Error(input) for unknown names, and for
/// those that are asked for nothing, or twice.
[[nodiscard]] std::vector<std::vector<SurfaceSide>> sides_of(const FitArguments& arguments,
                                                             std::span<const UncertainModel> series, Surface surface);

/// Nothing passes through a closed surface: throws Error(input) where a primitive is to.
void check_openings(const FitArguments& arguments, const Mesh& mesh);

}  // namespace verisq::command_line
