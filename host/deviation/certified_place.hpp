/// Finds what proves that a patch of a primitive's surface is part of the model's surface, or is not.
#pragma once

#include <optional>
#include <vector>

#include "host/threads/seen_interruption.hpp"
#include "verify/deviation/proven_samples.hpp"
#include "verify/deviation/surface_patch.hpp"
#include "verify/proof/exact_checker.hpp"
#include "verisq/deviation_certificate.hpp"
#include "verisq/model.hpp"
#include "verisq/signed_distance.hpp"

namespace verisq {

/// Uses no device. Immutable after construction: safe to call from many threads.
class PatchPlacer {
 public:
  /// `interrupted` must outlive this.
  PatchPlacer(const Model& model, const SeenInterruption& interrupted);

  /// A point that proves, as a checker has it, that no part of the patch is part of the boundary.
  [[nodiscard]] std::optional<CertifiedPoint> off_boundary(const verify::Patch& patch, std::size_t primitive) const;

  /// One that proves that all of it is.
  [[nodiscard]] std::optional<CertifiedPoint> on_boundary(const verify::Patch& patch, std::size_t primitive) const;

  /// The signed distance of a point near the boundary.
  [[nodiscard]] CertifiedPoint near_boundary(const Point& x, double tolerance) const;

 private:
  [[nodiscard]] CertifiedEnclosure between_both_sides(const Point& x, double tolerance) const;
  [[nodiscard]] std::optional<CertifiedPoint> inside(const verify::Patch& patch, std::size_t other) const;
  [[nodiscard]] std::optional<CertifiedPoint> off_boundary_of_set(const verify::Patch& patch) const;
  [[nodiscard]] std::optional<CertifiedPoint> proven_off(const verify::Patch& patch, CertifiedPoint point) const;
  [[nodiscard]] std::optional<std::vector<Normal>> away_from(const verify::Patch& patch, std::size_t other) const;

  SignedDistance distance_;
  std::vector<SignedDistance> each_;  ///< of each primitive by itself
  verify::ExactChecker checker_;
  verify::ProvenSamples samples_;
  const SeenInterruption& interrupted_;
};

}  // namespace verisq
