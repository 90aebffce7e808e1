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

// Chooses the cells to divide so that a mean, a percentile or a share gets narrower; the choice proves nothing.

/// Each of them marks in `chosen` the cells that contribute most to the width, and none if the enclosure is as narrow
/// as allowed. The enclosure is that of the mean, of the percentile of a part of all weight, or of the share within a
/// distance. Precondition: as many chosen as cells; the enclosure belongs to these cells.
void choose_for_mean(std::span<const WeightedCell> cells, const Enclosure& mean, double allowed,
                     std::vector<bool>& chosen);
void choose_for_percentile(std::span<const WeightedCell> cells, const Enclosure& value, double part, double allowed,
                           std::vector<bool>& chosen);
void choose_for_share(std::span<const WeightedCell> cells, const AreaWithin& within, double distance, double allowed,
                      std::vector<bool>& chosen);

// The largest distance of the surface of a model from triangles: branch and bound over patches that cover it
// (docs/mathematics.md §20).

struct FarthestOfModel {
  Enclosure distance;  ///< the supremum over the boundary of the model's solid
  Point where{};  ///< this point is `distance.lo` away from the triangles; a point of the boundary lies within rounding
                  ///< of it
  std::uint64_t patches = 0;
  std::uint64_t samples = 0;
  bool ended = false;  ///< early: the upper end is the best known by then
};

/// Precondition: the solid is bounded, as every model's is, and has a boundary.
[[nodiscard]] FarthestOfModel farthest_of_model(const Model& model, const TriangleTree& triangles,
                                                const DeviationSearch& search);

// The distances of a model's boundary from triangles: the mean by area, and percentiles (docs/mathematics.md §20).

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

/// The area of the boundary on the primitives that count (all if `counted` is empty), and the area of it no farther
/// than `distance`. Works until the share is no wider than `width`.
[[nodiscard]] ModelWithin model_within(const Model& model, const TriangleTree& triangles,
                                       const std::vector<bool>& counted, double distance, double width,
                                       const DeviationSearch& search);

}  // namespace verisq::verify
