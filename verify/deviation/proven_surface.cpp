/// Follows the halvings of the patches, then bounds each that is left by itself.
#include "verify/deviation/proven_surface.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "verify/analysis/finite_point.hpp"
#include "verify/deviation/patch_distance.hpp"
#include "verify/deviation/triangle_distance_bounds.hpp"
#include "verify/deviation/triangle_piece.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/proof/intersection.hpp"

namespace verisq::verify {

namespace {

/// A patch that is not halved any more.
struct Leaf {
  PatchCell cell;
  const CertifiedPoint* off;  ///< what is said to prove that it is no part of the boundary
};

/// Makes the patches that a proof names: the octants cover the surface, and halves what is halved.
class Walk {
 public:
  Walk(const Model& model, const SurfaceProof& proof) : proof_(proof) {
    for (std::uint32_t k = 0; k < model.primitives.size(); ++k) surfaces_.emplace_back(model.primitives[k], k);
  }

  /// Nothing where the leaves are not proven to cover all primitives' surfaces.
  [[nodiscard]] std::optional<std::vector<Leaf>> leaves() {
    if (proof_.patches.size() != surfaces_.size() || parts_of(proof_) > most_patches) return std::nullopt;
    for (std::size_t k = 0; k < surfaces_.size(); ++k) {
      if (!follow(surfaces_[k], proof_.patches[k])) return std::nullopt;
    }
    return std::move(leaves_);
  }

  [[nodiscard]] const PatchedSurface& surface_of(const PatchCell& cell) const { return surfaces_[cell.primitive]; }

 private:
  [[nodiscard]] bool follow(PatchedSurface& surface, std::span<const PatchProof> steps) {
    std::vector<PatchCell> open = surface.octants();
    std::ranges::reverse(open);
    for (const PatchProof step : steps) {
      if (open.empty()) return false;
      const PatchCell cell = open.back();
      open.pop_back();
      surface.prepare(cell);
      if (step == PatchProof::near || step == PatchProof::off) {
        if (!add_leaf(cell, step)) return false;
        continue;
      }
      if (cell.halvings == most_halvings_of_patch) return false;
      const bool is_along = step == PatchProof::halved_along;
      const auto halves = surface.halves(cell, is_along ? PatchHalving::along : PatchHalving::around);
      open.insert(open.end(), {halves[1], halves[0]});
    }
    return open.empty();
  }

  [[nodiscard]] bool add_leaf(const PatchCell& cell, PatchProof step) {
    if (step == PatchProof::off && used_ == proof_.off.size()) return false;
    leaves_.push_back({cell, step == PatchProof::off ? &proof_.off[used_++] : nullptr});
    return true;
  }

  const SurfaceProof& proof_;
  std::vector<PatchedSurface> surfaces_;  // one a primitive
  std::vector<Leaf> leaves_;
  std::size_t used_ = 0;  // of the points off the boundary
};

/// Of the boundary, whichever part of it lies on the patch. Infinite where numbers leave binary64.
double farthest_of_leaf(const Leaf& leaf, const PatchedSurface& surface, const TriangleTree& tree, double enough,
                        const ProvenSignedDistance& distance) try {
  const Patch patch = surface.patch(leaf.cell);
  if (leaf.off != nullptr && is_finite(leaf.off->point) &&
      is_off_boundary(patch, leaf.off->point, distance(leaf.off->point, leaf.off->signed_distance)))
    return 0.0;
  const double farthest = distance_from(patch, tree, enough).farthest;
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

}  // namespace

/// |sd(x)| is the distance of x from the boundary: in the ball of this radius about x there is none of it, and the
/// patch lies in a smaller one.
bool is_off_boundary(const Patch& patch, const Point& x, const Enclosure& signed_distance) {
  return magnitude(signed_distance).lo > patch.radius_about(x);
}

std::size_t parts_of(const SurfaceProof& proof) {
  std::size_t parts = 1;  // the farthest point
  for (const std::vector<PatchProof>& patches : proof.patches) parts += patches.size();
  return parts;
}

Enclosure farthest_of_surface(const Model& model, const std::vector<Triangle>& triangles, const SurfaceProof& proof,
                              const ProvenSignedDistance& distance, CheckSteps& steps) {
  double lower = 0.0;
  steps.each(1, [&](std::size_t) { lower = lower_end(proof.farthest, triangles, distance); });
  Walk walk(model, proof);
  const std::optional<std::vector<Leaf>> leaves = walk.leaves();
  if (!leaves) return {lower, infinity};
  const TriangleTree tree(triangles);
  std::vector<double> bounds(leaves->size(), infinity);
  steps.each(bounds.size(), [&](std::size_t i) {
    const Leaf& leaf = (*leaves)[i];
    bounds[i] = farthest_of_leaf(leaf, walk.surface_of(leaf.cell), tree, proof.within, distance);
  });
  // The boundary is part of the primitives' surfaces, which the leaves cover. `within` only widens: what is proven does
  // not depend on how its bounds are rounded then.
  double upper = std::isnan(proof.within) ? 0.0 : std::max(0.0, proof.within);
  for (const double bound : bounds) upper = std::max(upper, bound);
  return between(lower, upper, [] { return "the distance of the model's surface"; });
}

}  // namespace verisq::verify
