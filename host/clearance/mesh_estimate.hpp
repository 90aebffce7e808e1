/// How close a whole mesh comes to a solid by distances that are proposed, not proven: for searches.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "verisq/mesh_clearance.hpp"

namespace verisq {

/// Of each point; about, and about 1-Lipschitz.
using ProposedDistances = std::function<std::vector<double>(std::span<const Point>)>;

/// As mesh_clearance, by these distances: its counts and ends are estimates. Precondition: the mesh has triangles; the
/// options' device is not asked.
[[nodiscard]] MeshClearance mesh_estimate(const ProposedDistances& distances, const Mesh& mesh,
                                          const MeshClearanceOptions& options);

}  // namespace verisq
