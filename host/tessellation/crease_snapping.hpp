/// Moves vertices of a surface onto the creases where two primitives meet, so that no edge runs across.
#pragma once

#include <vector>

#include "host/tessellation/solid.hpp"
#include "host/tessellation/tetrahedra_surface.hpp"

namespace verisq::tessellation {

/// Of each edge between vertices of two primitives the one nearer to the crease, where no triangle then turns over or
/// loses its area. Returns for each vertex whether it was moved.
std::vector<bool> snap_to_creases(const Solid& solid, TetrahedraSurface& surface);

}  // namespace verisq::tessellation
