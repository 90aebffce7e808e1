/// On which side of the mesh an implant's parts have to be, from what is asked for and the mesh itself.
#pragma once

#include <span>
#include <string>
#include <vector>
#include <verisq/fit_problem.hpp>
#include <verisq/mesh.hpp>
#include <verisq/sides.hpp>
#include <verisq/uncertain_model.hpp>

namespace verisq::planning {

/// What the mesh bounds; `has_sides` where its triangles keep the limit. Says in `notices` what it takes for granted.
/// Throws Error(input) where the user has to say, and for a surface that is not what the user says.
[[nodiscard]] FitSurface surface_of(const FitRequest& request, const Mesh& mesh, bool has_sides,
                                    std::vector<std::string>& notices);

/// One a primitive for each implant; none where the surface is unsided. Throws Error(input) for unknown names, and for
/// those that are asked for nothing, or twice.
[[nodiscard]] std::vector<std::vector<SurfaceSide>> sides_of(const FitRequest& request,
                                                             std::span<const UncertainModel> series,
                                                             FitSurface surface);

/// Nothing passes through a closed surface: throws Error(input) where a primitive is to.
void check_openings(const FitRequest& request, const Mesh& mesh);

}  // namespace verisq::planning
