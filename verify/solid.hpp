/// One posed superquadric, ready for proofs.
#pragma once

#include "verify/certificate.hpp"
#include "verify/pose.hpp"

namespace verisq::verify {

class Solid {
 public:
  explicit Solid(const Primitive& primitive);

  /// Signed distance of a point of the model frame.
  [[nodiscard]] CertifiedDistance signed_distance(const Point& x, double tolerance) const;

  /// A direction of the solid's frame in the model's, to nearest. Zero if v is not usable.
  [[nodiscard]] Proposal model_direction(const Proposal& v) const { return frame_.model_direction(v); }

  /// A cheap lower bound of the signed distance, from a sphere about the solid. Rounded down.
  [[nodiscard]] double sphere_bound(const Point& x) const;

  /// How far along x + s u the supporting plane of normal u lies: beyond the returned s (rounded up) every point of the
  /// ray is outside. Precondition: u is usable.
  [[nodiscard]] double ray_clearance(const Point& x, const Proposal& u) const;

  /// Whether x + s u is proven to lie outside, at a positive distance.
  [[nodiscard]] bool separated(const Point& x, const Proposal& u, double s) const;

  /// Whether x is proven to lie outside.
  [[nodiscard]] bool excludes(const Point& x) const;

  /// The corners of the bounding box of the solid's posed box, along each axis of the model frame.
  [[nodiscard]] PreciseVector bounding_box() const;

 private:
  Superquadric superquadric_;
  SuperquadricBounds<Real> bounds_;
  Frame frame_;
  PreciseInterval radius_;  ///< of a sphere about the solid's centre that contains it
};

}  // namespace verisq::verify
