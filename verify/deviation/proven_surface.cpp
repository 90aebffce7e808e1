/// Bounds each patch by itself, then all of them together.
#include "verify/deviation/proven_surface.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "verify/analysis/finite_point.hpp"
#include "verify/deviation/patch_distance.hpp"
#include "verify/deviation/triangle_distance_bounds.hpp"
#include "verify/deviation/triangle_piece.hpp"
#include "verify/deviation/weighted_patch.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/proof/intersection.hpp"

namespace verisq::verify {

namespace {

/// Of the boundary, whichever part of it lies on the patch. Infinite where numbers leave binary64.
double farthest_of_patch(const CoveredSurface& surface, const PlacedPatch& placed, const TriangleTree& tree,
                         double enough) try {
  if (placed.place == PatchPlace::off) return 0.0;
  const double farthest = distance_from(surface.surface_of(placed.cell).patch(placed.cell), tree, enough).farthest;
  return farthest >= 0.0 ? farthest : infinity;  // NaN is no bound
} catch (const std::domain_error&) {             // of an interval without numbers, where its ends overflow
  return infinity;
}

/// From all triangles, one by one: no tree has to be believed.
double distance_down(const Point& x, const std::vector<Triangle>& triangles) {
  double least = infinity;
  for (const Triangle& triangle : triangles) least = std::min(least, distance_from_triangle(x, triangle).lo);
  return least;
}

/// A point of the boundary lies within |sd(x)| of x, and the distance from the triangles is 1-Lipschitz.
double lower_end(const CertifiedPoint& farthest, const std::vector<Triangle>& triangles,
                 const ProvenSignedDistance& distance) {
  if (!is_finite(farthest.point)) return 0.0;
  const Enclosure from_boundary = magnitude(distance(farthest.point, farthest.signed_distance));
  return std::max(0.0, subtract(distance_down(farthest.point, triangles), from_boundary.hi, Direction::down));
}

/// The boundary is part of the primitives' surfaces, which the patches cover. `within` only widens: what is proven does
/// not depend on how its bounds are rounded then.
double upper_end(const CoveredSurface& surface, const TriangleTree& tree, double within, CheckSteps& steps) {
  std::vector<double> bounds(surface.patches.size(), infinity);
  steps.each(bounds.size(),
             [&](std::size_t i) { bounds[i] = farthest_of_patch(surface, surface.patches[i], tree, within); });
  double upper = std::isnan(within) ? 0.0 : std::max(0.0, within);
  for (const double bound : bounds) upper = std::max(upper, bound);
  return upper;
}

/// Nothing where it is not known to be finite.
std::optional<WeightedCell> cell_of(const CoveredSurface& surface, const PlacedPatch& placed, const TriangleTree& tree,
                                    double largest) try {
  const PatchedSurface& of = surface.surface_of(placed.cell);
  const WeightedCell cell = on_boundary(weighted_patch(of.patch(placed.cell), of.area(placed.cell), tree),
                                        placed.place == PatchPlace::on, largest);
  const bool is_known = std::isfinite(cell.weight.hi) && cell.weight.lo >= 0.0 && cell.range.lo >= 0.0 &&
                        cell.range.hi >= 0.0 && cell.mean.lo >= 0.0 && cell.mean.hi >= 0.0;  // no NaN
  return is_known ? std::optional(cell) : std::nullopt;
} catch (const std::domain_error&) {  // of an interval without numbers, where its ends overflow
  return std::nullopt;
}

AreaStatistics statistics_of(const CoveredSurface& surface, const TriangleTree& tree, double largest,
                             std::span<const double> percentiles, CheckSteps& steps) {
  AreaStatistics result;
  result.percentiles.resize(percentiles.size(), {0.0, infinity});
  const auto cells = boundary_cells(surface, tree, largest, steps);
  if (!cells) return result;
  result.mean = mean_of(*cells);
  const Distribution distribution(*cells);
  std::ranges::transform(percentiles, result.percentiles.begin(),
                         [&](double percent) { return distribution.percentile(percent); });
  return result;
}

}  // namespace

/// Of what is farther than any point of the boundary nothing is part of it.
std::optional<std::vector<WeightedCell>> boundary_cells(const CoveredSurface& surface, const TriangleTree& tree,
                                                        double largest, CheckSteps& steps) {
  std::vector<std::optional<WeightedCell>> cells(surface.patches.size());
  steps.each(cells.size(), [&](std::size_t i) {
    if (surface.patches[i].place != PatchPlace::off) cells[i] = cell_of(surface, surface.patches[i], tree, largest);
  });
  std::vector<WeightedCell> known;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (surface.patches[i].place == PatchPlace::off) continue;
    if (!cells[i]) return std::nullopt;
    if (cells[i]->range.lo <= largest) known.push_back(*cells[i]);
  }
  return known.empty() ? std::nullopt : std::optional(std::move(known));
}

std::size_t parts_of(const SurfaceProof& proof) {
  return 1 + 3 * parts_of(proof.cover);  // the farthest point; where patches lie, how far, how far in the mean
}

ProvenSurface proven_surface(const std::vector<Triangle>& triangles, const SurfaceProof& proof,
                             const DeviationChecker::Options& options, const ProvenSamples& samples,
                             const ProvenSignedDistance& distance, CheckSteps& steps) {
  ProvenSurface result;
  if (options.statistics_of_model) result.statistics.percentiles.resize(options.percentiles.size(), {0.0, infinity});
  steps.each(1, [&](std::size_t) { result.largest.lo = lower_end(proof.farthest, triangles, distance); });
  const std::optional<CoveredSurface> surface = covered_surface(proof.cover, {}, samples, distance, steps);
  if (!surface) return result;
  const TriangleTree tree(triangles);
  result.largest = between(result.largest.lo, upper_end(*surface, tree, proof.within, steps),
                           [] { return "the distance of the model's surface"; });
  if (options.statistics_of_model)
    result.statistics = statistics_of(*surface, tree, result.largest.hi, options.percentiles, steps);
  return result;
}

}  // namespace verisq::verify
