/// The test oracle: the exact signed distance of a point to one posed convex superquadric, by MPFR at 200 bits. It
/// shares no code with verify/ and kernels/, only the mathematics: the certificates of docs/mathematics.md §2 hold for
/// any candidate however found, so an oracle that fails to converge is wide, not wrong.
#pragma once

#include <verisq/model.hpp>

#include "tests/oracle/depth.hpp"
#include "tests/oracle/mixed_norm.hpp"

namespace verisq::oracle {

/// `lower` is proven to be at most the signed distance, at every point. `upper` is proven to be at least the signed
/// distance where `upper_is_proven` (outside and on the boundary). Inside, `upper` is the best local answer of a
/// search over directions: below the truth only if the search missed the nearest boundary point.
struct ReferenceDistance {
  Real lower;
  Real upper;
  bool upper_is_proven;
};

/// A ball that contains the closest point of the surface. Proven outside; inside the search may have missed a nearer
/// one, and did not converge where the radius is not tiny.
struct ReferencePoint {
  ReferenceDistance distance;
  Vector centre;
  Real radius;
};

class PosedSolid {
 public:
  PosedSolid(const Superquadric& superquadric, const Pose& pose);

  /// `search` matters inside only.
  [[nodiscard]] ReferenceDistance signed_distance(const Point& point, Search search = Search::usual) const;

  /// Precondition: the point is farther from the surface than rounding.
  [[nodiscard]] ReferencePoint closest_point(const Point& point, Search search = Search::usual) const;

  /// R^T (point - t), to within 2^-190 (|point| + |t|).
  [[nodiscard]] Vector to_own_frame(const Vector& point) const;
  [[nodiscard]] Vector from_own_frame(const Vector& local) const;

  /// R^T v, of a direction.
  [[nodiscard]] Vector turned_to_own_frame(const Vector& v) const;

  /// The solid after a further rigid motion; no rounding but that of 200 bits.
  [[nodiscard]] PosedSolid moved(const Pose& motion) const;

  [[nodiscard]] const Superquadric& superquadric() const { return superquadric_; }
  [[nodiscard]] const Vector& centre() const { return translation_; }
  [[nodiscard]] const Real& largest_semi_axis() const { return largest_semi_axis_; }
  [[nodiscard]] const MixedNorm<Real>& norm() const { return norm_; }

  /// What a gap of `signed_distance` is to be compared with: the larger of |q| and the largest semi-axis.
  [[nodiscard]] Real magnitude(const Point& point) const;

 private:
  [[nodiscard]] Real rounding_at(const Vector& point) const;

  Superquadric superquadric_;
  MixedNorm<Real> norm_;
  Vector translation_;
  Triple<Vector> rotation_;  ///< rows of R
  Real largest_semi_axis_;
};

}  // namespace verisq::oracle
