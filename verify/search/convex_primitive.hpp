/// One posed superquadric, ready for searches and their proofs.
#pragma once

#include "verify/proof/posed_superquadric.hpp"
#include "verify/search/certified_distance.hpp"

namespace verisq::verify {

class ConvexPrimitive {
 public:
  explicit ConvexPrimitive(const Primitive& primitive) : proof_(primitive) {}

  /// Signed distance of a point of the model frame.
  [[nodiscard]] CertifiedDistance signed_distance(const Point& x, double tolerance) const;

  /// A direction of the solid's frame in the model's, to nearest. Zero if v is not usable.
  [[nodiscard]] Proposal model_direction(const Proposal& v) const {
    return usable(v) ? midpoint(proof_.motion().rotation * precise(v)) : Proposal{};
  }

  /// What needs no search.
  [[nodiscard]] const PosedSuperquadric& proof() const { return proof_; }

  /// How far along x + s u the supporting plane of normal u lies: beyond the returned s (rounded up) every point of the
  /// ray is outside. Precondition: u is usable.
  [[nodiscard]] double ray_clearance(const Point& x, const Proposal& u) const;

  /// Whether x + s u is proven to lie outside, at a positive distance.
  [[nodiscard]] bool separated(const Point& x, const Proposal& u, double s) const;

  /// Whether x is proven to lie outside.
  [[nodiscard]] bool excludes(const Point& x) const {
    return proof_.lower_by_sphere(x) > 0.0 || proof_.bounds().gauge(proof_.motion().local_point(x)).lower() > Real(1);
  }

  /// The corners of the bounding box of the solid's posed box, along each axis of the model frame.
  [[nodiscard]] PreciseVector bounding_box() const;

 private:
  PosedSuperquadric proof_;
};

}  // namespace verisq::verify
