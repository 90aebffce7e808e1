/// Distances that are proven on a whole surface.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "verify/proof/check_steps.hpp"
#include "verify/proof/exact_checker.hpp"
#include "verify/proof/surface_patch.hpp"
#include "verify/proof/triangle_piece.hpp"
#include "verify/proof/triangle_tree.hpp"
#include "verisq/checker.hpp"
#include "verisq/deviation.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// Upper bounds of the distances of a patch's points from many triangles (docs/mathematics.md §20).

struct PatchDistance {
  double farthest;      ///< no point of the patch is farther from the nearest of the triangles
  Enclosure of_sample;  ///< the distance of the patch's sample
};

/// Stops as soon as the bound is below `enough`. It does not depend on the tree's search that `farthest` is no less
/// than any distance: it is a distance from the triangles that the search returns.
[[nodiscard]] PatchDistance distance_from(const Patch& patch, const TriangleTree& triangles, double enough);

// Distances of a patch's points from many triangles, and their mean by area (docs/mathematics.md §20).

/// The patch weighed by its area; all of its distances are `known` in advance to lie in this enclosure. The result
/// depends on a finding of the tree's search: that no triangle is nearer.
[[nodiscard]] WeightedCell weighted_patch(const Patch& patch, const PatchArea& area, const TriangleTree& triangles,
                                          const Enclosure& known = {0.0, infinity});

/// The part of a patch on the model's boundary, for a patch that may lie on it in part. The part's points are no
/// farther than `largest`; their mean is any number of the range.
[[nodiscard]] WeightedCell on_boundary(WeightedCell patch, bool whole, double largest);

// The bounds that certificates of signed distances at points prove for a model, whatever they claim
// (docs/mathematics.md §20).

/// Immutable after construction: safe to call from many threads.
class ProvenSamples {
 public:
  explicit ProvenSamples(const Model& model);

  [[nodiscard]] const Model& model() const { return model_; }
  /// Returns whether the model is one convex primitive.
  [[nodiscard]] bool convex() const { return convex_; }

  /// The claim if its certificate proves it; else the proven enclosure, with `proved` false. `interrupted`, unless
  /// empty, is polled here and below; once it returns true, less is proven.
  [[nodiscard]] Enclosure distance(const Point& x, const CertifiedEnclosure& claimed, bool& proved,
                                   const Hook& interrupted = {}) const;

  /// The function `is_one_convex` of `SampleProofs`. False for a model with meshes.
  [[nodiscard]] bool is_one_convex(const Point& x, double reach, const Certificate& certificate) const;

  /// Returns whether the model is the union of its primitives.
  [[nodiscard]] bool is_union() const { return is_union_; }

  /// Returns whether it is proven that no other primitive's surface comes within `reach` of the point, by spheres and
  /// the normals of the certificate. Then every other primitive is farther or, if the model is not their union,
  /// contains all of that ball. False for a model with meshes.
  [[nodiscard]] bool are_others_away(const Point& x, double reach, std::size_t primitive,
                                     const Certificate& certificate, const Hook& interrupted = {}) const;

 private:
  Model model_;
  Checker checker_;
  std::optional<ExactChecker> primitives_;  ///< of a model without meshes
  bool is_union_;
  bool convex_;
};

/// The samples of one certificate, while many threads check them. `samples` must outlive this.
class SampleTally {
 public:
  SampleTally(const ProvenSamples& samples, Hook interrupted)
      : samples_(samples), interrupted_(std::move(interrupted)) {}

  [[nodiscard]] Enclosure operator()(const Point& x, const CertifiedEnclosure& claimed);

  /// Refers to this.
  [[nodiscard]] SampleProofs proofs();

  [[nodiscard]] std::uint64_t looked_at() const { return looked_at_; }
  /// The number of samples that prove less than they claim, or were interrupted.
  [[nodiscard]] std::uint64_t unproved() const { return unproved_; }

 private:
  const ProvenSamples& samples_;
  Hook interrupted_;
  std::atomic<std::uint64_t> looked_at_{0};
  std::atomic<std::uint64_t> unproved_{0};
};

// Proposed patches that cover the surface of a model's primitives, and the proven place of each (docs/mathematics.md
// §20).

/// The proven enclosure of the signed distance at a finite point, whatever is claimed.
using ProvenSignedDistance = std::function<Enclosure(const Point& x, const CertifiedEnclosure& claimed)>;

/// Returns whether no point of the patch lies on the boundary of the model's solid, by the proven distance of the point
/// x.
[[nodiscard]] bool is_off_boundary(const Patch& patch, const Point& x, const Enclosure& signed_distance);

/// Returns whether all of a patch of this primitive's surface lies on that boundary, by a point that need not be near.
[[nodiscard]] bool is_on_boundary(const Patch& patch, std::size_t primitive, const CertifiedPoint& by,
                                  const ProvenSamples& samples, const ProvenSignedDistance& distance,
                                  const Hook& interrupted = {});

/// The place of a patch relative to the boundary of the model's solid.
enum class PatchPlace : std::uint8_t {
  open,  ///< any part of the patch may be part of the boundary
  on,    ///< all of the patch is part of it
  off,   ///< no part of the patch is part of it
};

/// A patch that is not halved any more.
struct PlacedPatch {
  PatchCell cell;
  PatchPlace place;
};

struct CoveredSurface {
  std::vector<PatchedSurface> surfaces;  ///< one a primitive
  std::vector<PlacedPatch> patches;      ///< prepared

  [[nodiscard]] const PatchedSurface& surface_of(const PatchCell& cell) const { return surfaces[cell.primitive]; }
};

/// Follows the halvings, and proves where the patches lie. Nothing if they are not proven to cover the surfaces of all
/// primitives that count (all primitives if `counted` is empty).
[[nodiscard]] std::optional<CoveredSurface> covered_surface(const SurfaceCover& cover, const std::vector<bool>& counted,
                                                            const ProvenSamples& samples,
                                                            const ProvenSignedDistance& distance, CheckSteps& steps);

/// An upper bound of the number of parts that `covered_surface` processes.
[[nodiscard]] std::size_t parts_of(const SurfaceCover& cover);

// The distance of the surface of a model from triangles, proven by proposed patches (docs/mathematics.md §20).

/// The distances of the solid's boundary from triangles that a proof proves.
struct ProvenSurface {
  Enclosure largest{0.0, infinity};  ///< by patches no closer than `within`; only the lower end is proven if a patch is
                                     ///< missing
  AreaStatistics statistics = {};    ///< as far as the patches' places are proven; with fewer percentiles, or none
};

/// Mean and percentiles as `options` ask for them. Precondition: at least one triangle, finite.
[[nodiscard]] ProvenSurface proven_surface(const std::vector<Triangle>& triangles, const SurfaceProof& proof,
                                           const DeviationChecker::Options& options, const ProvenSamples& samples,
                                           const ProvenSignedDistance& distance, CheckSteps& steps);

/// For each patch, the distances of its part on the boundary, by area, no larger than `largest`. Nothing if numbers
/// leave binary64, or if no patch may lie on the boundary.
[[nodiscard]] std::optional<std::vector<WeightedCell>> boundary_cells(const CoveredSurface& surface,
                                                                      const TriangleTree& tree, double largest,
                                                                      CheckSteps& steps);

/// An upper bound of the number of parts that `proven_surface` processes.
[[nodiscard]] std::size_t parts_of(const SurfaceProof& proof);

}  // namespace verisq::verify
