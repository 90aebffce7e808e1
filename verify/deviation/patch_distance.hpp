/// How far the points of a patch lie from many triangles, at most (docs/mathematics.md §20).
#pragma once

#include "verify/deviation/surface_patch.hpp"
#include "verify/deviation/triangle_tree.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

struct PatchDistance {
  double farthest;      ///< no point of the patch is farther from the nearest of the triangles
  Enclosure of_sample;  ///< the distance of the patch's sample
};

/// Tries no harder than to come below `enough`. That `farthest` is no less than any distance does not rest on the
/// tree's search: it is a distance from those triangles that the search happens to name.
[[nodiscard]] PatchDistance distance_from(const Patch& patch, const TriangleTree& triangles, double enough);

}  // namespace verisq::verify
