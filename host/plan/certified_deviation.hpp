/// The searches that certify how far a mesh and a surface lie apart, one triangle and one patch at a time.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/threads/parallel.hpp"
#include "verify/proof/exact_checker.hpp"
#include "verify/proof/proven_surface.hpp"
#include "verify/proof/surface_patch.hpp"
#include "verify/proof/triangle_piece.hpp"
#include "verify/proof/triangle_tree.hpp"
#include "verisq/checker.hpp"
#include "verisq/deviation.hpp"
#include "verisq/distance.hpp"
#include "verisq/model.hpp"

namespace verisq {

// Deviations with their certificates: certified distances, and the distances of a model's whole surface.

// Signed distances with their certificates, in the form that the proofs of triangles need (docs/mathematics.md §20).

/// Uses no device. Immutable after construction: safe to call from many threads.
class CertifiedSamples {
 public:
  /// Samples are about as wide as the tolerance.
  CertifiedSamples(const Model& model, double tolerance);

  [[nodiscard]] double tolerance() const { return tolerance_; }
  /// Returns whether the model is one convex primitive.
  [[nodiscard]] bool convex() const { return checked_.convex(); }

  [[nodiscard]] CertifiedEnclosure at(const Point& x, const std::function<bool()>& interrupted) const;

  /// For a model of several primitives: returns whether its part within reach is one convex primitive. If so, adds the
  /// normals that prove it, unless the certificate has them.
  [[nodiscard]] bool is_one_convex(const Point& x, double reach, Certificate& certificate) const;

 private:
  struct OnePrimitive {
    SignedDistance distance;
    bool bent;
  };

  SignedDistance model_;
  verify::ProvenSamples checked_;
  std::vector<OnePrimitive> each_;  ///< for a union of several primitives
  double tolerance_;
};

// The certificate of how far a model's surface lies from a mesh: patches that cover it.

struct CertifiedSurface {
  std::optional<SurfaceProof> proof;
  std::string missing;  ///< why there is none; empty where there is one, or it is interrupted
};

/// The certificate of the result that `deviation` found with the same arguments, in about `bytes` bytes of a file, or
/// nothing. Precondition: `found.from_model`.
[[nodiscard]] CertifiedSurface certified_surface(const Model& model, const Mesh& mesh, const Deviation& found,
                                                 const DeviationOptions& options, std::size_t bytes,
                                                 const SeenInterruption& interrupted,
                                                 const std::function<void(double)>& progress);

// Covers of a model's surface whose places are proven one by one, with their certificates.

// About how many bytes of a certificate file a point's certificate takes.

[[nodiscard]] inline std::size_t size_of(const CertifiedEnclosure& sample) {
  const auto& [normals, escape, weights, witness, cover] = sample.certificate;
  return 80 + 75 * normals.size() + (escape ? 75 : 0) + (witness ? 75 : 0) + cover.size() / 4;
}

[[nodiscard]] inline std::size_t size_of(const CertifiedPoint& point) {
  return 80 + size_of(point.signed_distance);
}

// Finds the proof that a patch of a primitive's surface is part of the model's surface, or is not.

/// Uses no device. Immutable after construction: safe to call from many threads.
class PatchPlacer {
 public:
  /// `interrupted` must outlive this.
  PatchPlacer(const Model& model, const SeenInterruption& interrupted);

  /// A point that proves, as a checker has it, that no part of the patch is part of the boundary.
  [[nodiscard]] std::optional<CertifiedPoint> off_boundary(const verify::Patch& patch, std::size_t primitive) const;

  /// A point that proves that all of the patch is on the boundary.
  [[nodiscard]] std::optional<CertifiedPoint> on_boundary(const verify::Patch& patch, std::size_t primitive) const;

  /// The signed distance of a point near the boundary.
  [[nodiscard]] CertifiedPoint near_boundary(const Point& x, double tolerance) const;

 private:
  [[nodiscard]] CertifiedEnclosure between_both_sides(const Point& x, double tolerance) const;
  [[nodiscard]] std::optional<CertifiedPoint> inside(const verify::Patch& patch, std::size_t other) const;
  [[nodiscard]] std::optional<CertifiedPoint> off_boundary_of_set(const verify::Patch& patch) const;
  [[nodiscard]] std::optional<CertifiedPoint> proven_off(const verify::Patch& patch, CertifiedPoint point) const;
  [[nodiscard]] std::optional<std::vector<Normal>> away_from(const verify::Patch& patch, std::size_t other) const;

  [[nodiscard]] std::function<bool()> hook() const {
    return [this] { return interrupted_(); };
  }

  SignedDistance distance_;
  std::vector<SignedDistance> each_;  ///< for each primitive by itself
  verify::ExactChecker checker_;
  verify::ProvenSamples samples_;
  const SeenInterruption& interrupted_;
};

// Patches of a model's surface, halved until the enclosures of their areas and distances are narrow enough, with the
// proofs of their places.

/// Marks the cells that must be divided; none if they are small enough.
using CoverGoal = std::function<void(std::span<const verify::WeightedCell> cells, std::vector<bool>& chosen)>;

/// The referenced objects must outlive it.
struct CoverRequest {
  const Model& model;
  const verify::TriangleTree& triangles;
  const PatchPlacer& placer;
  std::vector<bool> counted;  ///< as `ContactTerms`
  double largest;             ///< no point of the boundary is farther from the triangles
  CoverGoal choose;
  std::size_t bytes;  ///< size of a file, about
  const SeenInterruption& interrupted;
};

/// Halves the patches of a cover further, until the goal is reached, or the file would be too large; says where they
/// lie. Precondition: it covers the primitives that count.
[[nodiscard]] SurfaceCover certified_cover(const CoverRequest& request, SurfaceCover begun);

/// The octants of the primitives that count.
[[nodiscard]] SurfaceCover octants_of(const Model& model, const std::vector<bool>& counted);

}  // namespace verisq
