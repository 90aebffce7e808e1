/// One primitive's surface as a grid of longitudes and latitudes, as fine as the surface is curved.
#pragma once

#include <verisq/mesh.hpp>

#include "host/tessellation/placed_primitive.hpp"

namespace verisq::tessellation {

/// Closed, manifold, outward by the right-hand rule; vertices lie on the surface, some of them on its edges and
/// corners. Between them it is about `deviation` away at most.
[[nodiscard]] Mesh parametric_surface(const PlacedPrimitive& primitive, double deviation);

}  // namespace verisq::tessellation
