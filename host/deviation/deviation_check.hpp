/// Whether a mesh and the regions of its triangles are what the searches of `verify/deviation` ask for.
#pragma once

#include <cstdint>
#include <span>

#include "verisq/mesh.hpp"

namespace verisq {

/// Throws Error(input) for a mesh without vertices, coordinates that are not finite, and triangles that name vertices
/// which are not there.
void check_mesh(const Mesh& mesh);

/// Throws Error(input) unless there is a region of each triangle, below their number; where that is 0 none are asked
/// for.
void check_regions(const Mesh& mesh, std::span<const std::uint32_t> region_of, std::uint32_t regions);

}  // namespace verisq
