/// What a closed mesh says of the space about it, for the fit of a union.
#pragma once

#include <verisq/mesh.hpp>

#include "host/recovery/union_fit.hpp"
#include "verify/deviation/triangle_tree.hpp"

namespace verisq::recovery {

/// Adds a grid's points inside and outside; `tree` is of the mesh's triangles. Precondition: a closed mesh.
void add_space(const Mesh& mesh, const verify::TriangleTree& tree, UnionSamples& samples);

}  // namespace verisq::recovery
