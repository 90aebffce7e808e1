/// A posed mesh over cubes of the model's frame: colours, and half-spaces that hold the solid or its complement.
#pragma once

#include "verify/search/closed_mesh.hpp"
#include "verify/solids/cube.hpp"

namespace verisq::verify {

/// Colour of the solid. Black cubes are free of triangles, those within the solid, too. For a point: black where it is
/// proven to lie inside, white where it is proven to lie outside.
[[nodiscard]] Colour colour(const PosedMesh& mesh, const Cube& cube);

/// A half-space that contains the part of the solid, or of the closure of its complement, in the cube. It touches the
/// surface in the cube. It proves nothing where the surface has no one side, and where very many triangles meet the
/// cube.
[[nodiscard]] HalfSpace half_space(const PosedMesh& mesh, const Cube& cube, Side side);

}  // namespace verisq::verify
