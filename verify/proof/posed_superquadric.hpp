/// One posed superquadric K and what single evaluations prove about a point of the model frame.
///
/// The origin of K's own frame is its focus (docs/mathematics.md §18), without a taper its centre.
#pragma once

#include <optional>

#include "verify/proof/certificate.hpp"
#include "verify/proof/rigid_motion.hpp"

namespace verisq::verify {

/// Where the points c + e of the model frame, |e_i| <= half[i], lie in a primitive's own frame, about the origin of its
/// gauge: y(c + e) lies in `range`, and is centre + D e for a D in `derivative`.
struct OwnRegion {
  PreciseVector centre, range;
  PreciseMatrix derivative;
};

[[nodiscard]] inline PreciseVector box_of(const std::array<Real, 3>& half) {
  return {{-half[0], half[0]}, {-half[1], half[1]}, {-half[2], half[2]}};
}

/// Distances are rounded outward to binary64: comparing them with claims loses nothing, because the claims are binary64
/// numbers themselves.
class PosedSuperquadric {
 public:
  explicit PosedSuperquadric(const Primitive& primitive);

  [[nodiscard]] const Superquadric& superquadric() const { return superquadric_; }
  [[nodiscard]] const SuperquadricBounds<Real>& bounds() const { return bounds_; }
  [[nodiscard]] const RigidMotion& motion() const { return motion_; }  ///< from K's own frame
  /// The smallest box along the axes of K's own frame that contains K.
  [[nodiscard]] const PreciseVector& box() const { return box_; }
  /// Of a sphere about the origin that contains K.
  [[nodiscard]] const PreciseInterval& radius() const { return radius_; }

  /// sd(x) >= |x - origin| - radius
  [[nodiscard]] double lower_by_sphere(const PreciseVector& x) const;
  [[nodiscard]] double lower_by_sphere(const Point& x) const { return lower_by_sphere(precise(x)); }

  /// Whether no point of the box lies in K, as the sphere proves.
  [[nodiscard]] bool misses(const PreciseVector& box) const { return lower_by_sphere(box) > 0.0; }

  /// sd(x) >= (v·x - h(v)) / |v| for any v, in K's own frame like every v here.
  [[nodiscard]] double lower_by_normal(const Point& x, const Proposal& v) const;

  /// sd(x) <= |x - b|, where b = (x - v) / g(x - v) lies in K.
  [[nodiscard]] double upper_by_normal(const Point& x, const Proposal& v) const;

  /// Whether g(x) <= 1 is proven.
  [[nodiscard]] bool contains(const Point& x) const;

  /// Whether the ball is proven to lie in K, by covering it with cones, whatever v is.
  [[nodiscard]] bool contains_ball_about(const Point& x, double radius, const Proposal& v = {}) const;

  [[nodiscard]] std::optional<OwnRegion> over(const PreciseVector& centre, const std::array<Real, 3>& half) const;

 private:
  Superquadric superquadric_;
  SuperquadricBounds<Real> bounds_;
  RigidMotion motion_;
  PreciseVector box_;
  PreciseInterval radius_;
};

}  // namespace verisq::verify
