/// Turns the triangles of a mesh so that their normals point to one side.
#pragma once

#include <verisq/mesh.hpp>

namespace verisq::surface {

/// Normals away from the solid that the mesh bounds; those of cavities inside it point into the cavities. Of an open
/// mesh: such that its volume about its middle is positive. Where the mesh is no manifold, vertices are duplicated.
[[nodiscard]] Mesh oriented_outward(const Mesh& mesh);

/// Every triangle turned.
[[nodiscard]] Mesh reversed(Mesh mesh);

}  // namespace verisq::surface
