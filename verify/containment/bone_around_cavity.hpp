/// Whether a cavity lies in the bone that is said to be around it (docs/mathematics.md §23).
#pragma once

#include "verisq/bone_side.hpp"

namespace verisq::verify {

/// Throws Error(input) where nothing of a cavity's surface is inside of a surface that bounds bone from outside, but
/// for roundings: then it is another bone's, or in other coordinates, and that nothing is removed of the bone around
/// the cavity would be true, and no answer. Precondition: triangles of vertices that are there, finite coordinates,
/// surfaces with two sides (`require_sides`).
void require_cavities_in_bone(const BoneRegion& bone);

}  // namespace verisq::verify
