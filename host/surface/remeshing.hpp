/// Triangles of about equal sides.
#pragma once

#include <verisq/mesh.hpp>

namespace verisq::surface {

/// Splits, collapses and flips edges and relaxes vertices, which are then put back onto the surface (Botsch, Kobbelt: A
/// remeshing approach to multiresolution modeling, 2004), three times. Borders stay in place. Preconditions: manifold,
/// edge > 0.
[[nodiscard]] Mesh remeshed(const Mesh& mesh, double edge);

}  // namespace verisq::surface
