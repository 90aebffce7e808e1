/// How far the boundary of a model's solid lies from triangles in the mean by area, and percentiles
/// (docs/mathematics.md §20).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "verify/deviation/deviation_search.hpp"
#include "verify/deviation/triangle_tree.hpp"
#include "verisq/area_within.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

struct ModelDistances {
  Enclosure mean;
  std::vector<Enclosure> percentiles = {};
  std::uint64_t patches = 0;
  std::uint64_t samples = 0;
  bool ended = false;  ///< early: everything is valid, and something wide
};

/// `largest`: no point of the boundary is farther. Precondition: the solid has a boundary.
[[nodiscard]] ModelDistances distances_of_model(const Model& model, const TriangleTree& triangles,
                                                std::span<const double> percentiles, double largest,
                                                const DeviationSearch& search);

struct ModelWithin {
  AreaWithin within;
  std::uint64_t patches = 0;
  std::uint64_t samples = 0;
  bool ended = false;  ///< early: everything is valid, and something wide
};

/// Of the boundary's area that of the primitives that count (all where `counted` is empty) how much is no farther than
/// `distance`, until the share is no wider than `width`.
[[nodiscard]] ModelWithin model_within(const Model& model, const TriangleTree& triangles,
                                       const std::vector<bool>& counted, double distance, double width,
                                       const DeviationSearch& search);

}  // namespace verisq::verify
