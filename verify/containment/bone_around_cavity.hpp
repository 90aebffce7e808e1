/// Whether a cavity lies in the bone that is said to be around it (docs/mathematics.md §23).
#pragma once

#include <cstddef>
#include <functional>

#include "verify/containment/closed_surface.hpp"
#include "verisq/bone_side.hpp"

namespace verisq::verify {

/// Throws Error(input) where nothing of a cavity's surface is inside of a surface that bounds bone from outside, but
/// for roundings: then it is another bone's, or in other coordinates, and that nothing is removed of the bone around
/// the cavity would be true, and no answer. `closed` gives each of the bone's surfaces, closed over its rims.
/// Precondition: triangles of vertices that are there, finite coordinates.
void require_cavities_in_bone(const BoneRegion& bone, const std::function<const ClosedSurface&(std::size_t)>& closed);

}  // namespace verisq::verify
