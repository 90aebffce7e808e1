/// How far the surface of a model lies from triangles, at most: branch and bound over patches that cover it
/// (docs/mathematics.md §20).
#pragma once

#include <cstdint>

#include "verify/deviation/deviation_search.hpp"
#include "verify/deviation/triangle_tree.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

struct FarthestOfModel {
  Enclosure distance;  ///< the supremum over the boundary of the model's solid
  Point where{};       ///< a point of the boundary within rounding of it is `distance.lo` away
  std::uint64_t patches = 0;
  std::uint64_t samples = 0;
  bool ended = false;  ///< early: the upper end is the best known by then
};

/// Precondition: the solid is bounded, as every model's is, and has a boundary.
[[nodiscard]] FarthestOfModel farthest_of_model(const Model& model, const TriangleTree& triangles,
                                                const DeviationSearch& search);

}  // namespace verisq::verify
