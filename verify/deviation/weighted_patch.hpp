/// Distances of a patch's points from many triangles, and their mean by area (docs/mathematics.md §20).
#pragma once

#include "verify/deviation/patch_area.hpp"
#include "verify/deviation/surface_patch.hpp"
#include "verify/deviation/triangle_tree.hpp"
#include "verify/deviation/weighted_cells.hpp"

namespace verisq::verify {

/// Weighed by its area; of all of its distances it is `known` already where they lie. Rests on what the tree's search
/// finds: that no triangle is nearer.
[[nodiscard]] WeightedCell weighted_patch(const Patch& patch, const PatchArea& area, const TriangleTree& triangles,
                                          const Enclosure& known = {0.0, infinity});

/// Of what lies on the model's boundary of a patch that may lie on it in part: its points are no farther than
/// `largest`, and their mean is any of the range.
[[nodiscard]] WeightedCell on_boundary(WeightedCell patch, bool whole, double largest);

}  // namespace verisq::verify
