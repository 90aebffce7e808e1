/// One posed superquadric, ready for proofs.
#pragma once

#include "verify/certificate.hpp"
#include "verify/pose.hpp"

namespace verisq::verify {

class Solid {
 public:
  explicit Solid(const Primitive& primitive);

  /// Signed distance of a point of the model frame; `direction`, in the model frame too, certifies the lower end.
  [[nodiscard]] CertifiedDistance signed_distance(const Point& x, double tolerance) const;

  /// A cheap lower bound of the signed distance, from a sphere about the solid. Rounded down.
  [[nodiscard]] double sphere_bound(const Point& x) const;

  /// How far along x + s u the supporting plane of normal u lies: beyond the returned s (rounded up) every point of the
  /// ray is outside. Precondition: u is usable.
  [[nodiscard]] double ray_clearance(const Point& x, const Proposal& u) const;

  /// Whether x + s u is proven to lie outside, at a positive distance.
  [[nodiscard]] bool separated(const Point& x, const Proposal& u, double s) const;

  /// The corners of the bounding box of the solid's posed box, along each axis of the model frame.
  [[nodiscard]] PreciseVector bounding_box() const;

 private:
  Superquadric superquadric_;
  SuperquadricBounds<Real> bounds_;
  Frame frame_;
  PreciseInterval radius_;  ///< of a sphere about the solid's centre that contains it
};

}  // namespace verisq::verify
