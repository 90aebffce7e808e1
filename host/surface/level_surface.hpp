/// The surface on which a sampled function is zero.
#pragma once

#include <verisq/mesh.hpp>

#include "host/surface/grid_samples.hpp"

namespace verisq::surface {

/// Marching tetrahedra: every cell of the lattice is cut into Kuhn's six tetrahedra, in which the function is linear,
/// but that no vertex comes nearer to a sample than a fiftieth of its edge. The boundary of where the function is
/// positive: closed, manifold and outward. Preconditions: the outermost samples are not positive; less than 2^32
/// vertices.
[[nodiscard]] Mesh level_surface(const GridSamples& samples);

}  // namespace verisq::surface
