/// How near meshes come to a solid, between vertices too, and on which side of their surfaces it lies.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>
#include <verisq/mesh.hpp>

#include "verisq/clearance.hpp"

namespace verisq {

// Which way the normals of a surface point, where that is proven.

/// Returns 1 where the surface, closed over its rims, is proven to face outward, -1 where it is proven to face inward.
/// Returns nothing where neither is proven, as for surfaces that enclose almost nothing. Precondition: it has sides.
[[nodiscard]] std::optional<int> facing_of(const Mesh& surface);

// How close a whole mesh comes to a solid by distances that are proposed, not proven: for searches.

/// Of each point; about, and about 1-Lipschitz.
using ProposedDistances = std::function<std::vector<double>(std::span<const Point>)>;

/// As mesh_clearance, by these distances: its counts and ends are estimates. Precondition: the mesh has triangles; the
/// options' device is not asked.
[[nodiscard]] MeshClearance mesh_estimate(const ProposedDistances& distances, const Mesh& mesh,
                                          const MeshClearanceOptions& options);

}  // namespace verisq
