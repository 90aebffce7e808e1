/// Signed distances with their certificates, as the proofs of triangles need them (docs/mathematics.md §20).
#pragma once

#include <functional>
#include <vector>

#include "verify/deviation/proven_samples.hpp"
#include "verisq/certificate.hpp"
#include "verisq/model.hpp"
#include "verisq/signed_distance.hpp"

namespace verisq {

/// Uses no device. Immutable after construction: safe to call from many threads.
class CertifiedSamples {
 public:
  /// Samples are about as wide as the tolerance.
  CertifiedSamples(const Model& model, double tolerance);

  [[nodiscard]] double tolerance() const { return tolerance_; }
  /// Whether the model is one convex primitive.
  [[nodiscard]] bool convex() const { return checked_.convex(); }

  [[nodiscard]] CertifiedEnclosure at(const Point& x, const std::function<bool()>& interrupted) const;

  /// Whether all of a model of several primitives that is within reach is one of them, and convex; then adds the
  /// normals that say so, unless the certificate has them.
  [[nodiscard]] bool is_one_convex(const Point& x, double reach, Certificate& certificate) const;

 private:
  struct OnePrimitive {
    SignedDistance distance;
    bool bent;
  };

  SignedDistance model_;
  verify::ProvenSamples checked_;
  std::vector<OnePrimitive> each_;  ///< of a union of several
  double tolerance_;
};

}  // namespace verisq
