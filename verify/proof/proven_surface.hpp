/// Distances that are proven on a whole surface.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "verify/proof/exact_checker.hpp"
#include "verify/proof/surface_patch.hpp"
#include "verify/proof/triangle_piece.hpp"
#include "verify/proof/triangle_tree.hpp"
#include "verify/proof/verdict.hpp"
#include "verisq/checker.hpp"
#include "verisq/deviation.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// How far the points of a patch lie from many triangles, at most (docs/mathematics.md §20).

struct PatchDistance {
  double farthest;      ///< no point of the patch is farther from the nearest of the triangles
  Enclosure of_sample;  ///< the distance of the patch's sample
};

/// Tries no harder than to come below `enough`. That `farthest` is no less than any distance does not rest on the
/// tree's search: it is a distance from those triangles that the search happens to name.
[[nodiscard]] PatchDistance distance_from(const Patch& patch, const TriangleTree& triangles, double enough);

// Distances of a patch's points from many triangles, and their mean by area (docs/mathematics.md §20).

/// Weighed by its area; of all of its distances it is `known` already where they lie. Rests on what the tree's search
/// finds: that no triangle is nearer.
[[nodiscard]] WeightedCell weighted_patch(const Patch& patch, const PatchArea& area, const TriangleTree& triangles,
                                          const Enclosure& known = {0.0, infinity});

/// Of what lies on the model's boundary of a patch that may lie on it in part: its points are no farther than
/// `largest`, and their mean is any of the range.
[[nodiscard]] WeightedCell on_boundary(WeightedCell patch, bool whole, double largest);

// What certificates of signed distances at points prove of a model, whatever they claim (docs/mathematics.md §20).

/// Immutable after construction: safe to call from many threads.
class ProvenSamples {
 public:
  explicit ProvenSamples(const Model& model);

  [[nodiscard]] const Model& model() const { return model_; }
  /// Whether the model is one convex primitive.
  [[nodiscard]] bool convex() const { return convex_; }

  /// The claim where its certificate proves it; else what is proven instead, and `proved` is false. Once
  /// `interrupted`, polled unless empty, says so, less is proven; here and below.
  [[nodiscard]] Enclosure distance(const Point& x, const CertifiedEnclosure& claimed, bool& proved,
                                   const Hook& interrupted = {}) const;

  /// As `SampleProofs`.
  [[nodiscard]] bool is_one_convex(const Point& x, double reach, const Certificate& certificate) const;

  /// Whether the model is the union of its primitives.
  [[nodiscard]] bool is_union() const { return is_union_; }

  /// Whether nothing of the surface of any primitive but this one is proven to be within `reach` of the point, by
  /// spheres and the normals of the certificate: all others are farther or, where the model is not their union, hold
  /// all of that ball.
  [[nodiscard]] bool are_others_away(const Point& x, double reach, std::size_t primitive,
                                     const Certificate& certificate, const Hook& interrupted = {}) const;

 private:
  Model model_;
  Checker checker_;
  ExactChecker primitives_;
  bool is_union_;
  bool convex_;
};

/// The samples of one certificate as they are looked at, by many threads. `samples` must outlive it.
class SampleTally {
 public:
  SampleTally(const ProvenSamples& samples, Hook interrupted)
      : samples_(samples), interrupted_(std::move(interrupted)) {}

  [[nodiscard]] Enclosure operator()(const Point& x, const CertifiedEnclosure& claimed);

  /// Refers to this.
  [[nodiscard]] SampleProofs proofs();

  [[nodiscard]] std::uint64_t looked_at() const { return looked_at_; }
  /// Those that say less than they claim, or were interrupted.
  [[nodiscard]] std::uint64_t unproved() const { return unproved_; }

 private:
  const ProvenSamples& samples_;
  Hook interrupted_;
  std::atomic<std::uint64_t> looked_at_{0};
  std::atomic<std::uint64_t> unproved_{0};
};

// Patches that somebody proposes to cover the surface of a model's primitives, and where each is proven to lie
// (docs/mathematics.md §20).

/// What is proven of the signed distance at a finite point, whatever is claimed.
using ProvenSignedDistance = std::function<Enclosure(const Point& x, const CertifiedEnclosure& claimed)>;

/// Whether no point of the patch lies on the boundary of the model's solid, by what is proven of a point's distance.
[[nodiscard]] bool is_off_boundary(const Patch& patch, const Point& x, const Enclosure& signed_distance);

/// Whether all of a patch of this primitive's surface lies on that boundary, by a point that need not be near.
[[nodiscard]] bool is_on_boundary(const Patch& patch, std::size_t primitive, const CertifiedPoint& by,
                                  const ProvenSamples& samples, const ProvenSignedDistance& distance,
                                  const Hook& interrupted = {});

/// With respect to the boundary of the model's solid.
enum class PatchPlace : std::uint8_t {
  open,  ///< any part of it may be part of the boundary
  on,    ///< all of it is
  off,   ///< nothing of it
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

/// Follows the halvings, and proves where the patches lie. Nothing where they are not proven to cover the surfaces of
/// all primitives that count (all where `counted` is empty).
[[nodiscard]] std::optional<CoveredSurface> covered_surface(const SurfaceCover& cover, const std::vector<bool>& counted,
                                                            const ProvenSamples& samples,
                                                            const ProvenSignedDistance& distance, CheckSteps& steps);

/// How many parts `covered_surface` goes through, at most.
[[nodiscard]] std::size_t parts_of(const SurfaceCover& cover);

// How far the surface of a model lies from triangles, proven by patches that somebody proposes (docs/mathematics.md
// §20).

/// What a proof says of the distance of the solid's boundary from triangles.
struct ProvenSurface {
  Enclosure largest{0.0, infinity};  ///< by patches no closer than `within`; from below alone where one is missing
  AreaStatistics statistics = {};    ///< as far as patches say where they lie; of fewer percentiles, or none
};

/// Mean and percentiles as `options` ask for them. Precondition: at least one triangle, finite.
[[nodiscard]] ProvenSurface proven_surface(const std::vector<Triangle>& triangles, const SurfaceProof& proof,
                                           const DeviationChecker::Options& options, const ProvenSamples& samples,
                                           const ProvenSignedDistance& distance, CheckSteps& steps);

/// The distances of what of each patch lies on the boundary, by area, no larger than `largest`. Nothing where numbers
/// leave binary64, or no patch may lie there.
[[nodiscard]] std::optional<std::vector<WeightedCell>> boundary_cells(const CoveredSurface& surface,
                                                                      const TriangleTree& tree, double largest,
                                                                      CheckSteps& steps);

/// How many parts `proven_surface` goes through, at most.
[[nodiscard]] std::size_t parts_of(const SurfaceProof& proof);

}  // namespace verisq::verify
