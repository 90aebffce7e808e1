/// The clearance of meshes to a solid, between vertices too, and the side of their surfaces on which it lies.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>
#include <verisq/mesh.hpp>

#include "verisq/clearance.hpp"

namespace verisq {

// The direction of a surface's normals, if that is proven.

/// Returns 1 if the surface, closed over its rims, is proven to face outward, -1 if it is proven to face inward.
/// Returns nothing if neither is proven, as for surfaces that enclose almost nothing. Precondition: it has sides.
[[nodiscard]] std::optional<int> facing_of(const Mesh& surface);

// The clearance of a whole mesh to a solid by distances that are proposed, not proven: for searches.

/// The distance of each point: approximate, and approximately 1-Lipschitz.
using ProposedDistances = std::function<std::vector<double>(std::span<const Point>)>;

/// Like mesh_clearance, by these distances: its counts and ends are estimates. Precondition: the mesh has triangles;
/// the options' device is not used.
[[nodiscard]] MeshClearance mesh_estimate(const ProposedDistances& distances, const Mesh& mesh,
                                          const MeshClearanceOptions& options);

}  // namespace verisq
