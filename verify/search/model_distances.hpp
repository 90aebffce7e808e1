/// Distances of a model's surface to a mesh.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "verify/proof/triangle_piece.hpp"
#include "verify/proof/triangle_tree.hpp"
#include "verify/search/mesh_distances.hpp"
#include "verisq/clearance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// Which cells have to be smaller so that a mean, a percentile or a share is known better; nothing is proven by it.

/// Each of them marks what leaves most open in `chosen`, and nothing where the enclosure is as narrow as allowed: those
/// of the mean, of the least distance that a part of all weight does not exceed, of the share within a distance.
/// Precondition: as many chosen as cells, of which the enclosure is.
void choose_for_mean(std::span<const WeightedCell> cells, const Enclosure& mean, double allowed,
                     std::vector<bool>& chosen);
void choose_for_percentile(std::span<const WeightedCell> cells, const Enclosure& value, double part, double allowed,
                           std::vector<bool>& chosen);
void choose_for_share(std::span<const WeightedCell> cells, const AreaWithin& within, double distance, double allowed,
                      std::vector<bool>& chosen);

// How far the surface of a model lies from triangles, at most: branch and bound over patches that cover it
// (docs/mathematics.md §20).

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

// How far the boundary of a model's solid lies from triangles in the mean by area, and percentiles
// (docs/mathematics.md §20).

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
