/// The distance of a point to one bent superquadric by a single certificate, where that is a convex problem.
#pragma once

#include "verify/proof/certificate.hpp"
#include "verify/proof/rigid_motion.hpp"
#include "verify/sets/bend.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// Let K be the unbent solid, convex, and β its bend. In the plane of the bend let a point have the polar coordinates
/// W / |k| and γ about the centre of curvature: of β(x) for x = (r, s, z) in K they are W = 1 - k r, γ = k z, of the
/// query q they are W_q, γ_q. With δ = γ - γ_q the squared distance to the query is
///     f(x) = |β(x) - q|² = (W² + W_q² - 2 W W_q cos δ) / k² + (s - s_q)².
/// W and γ are linear in x, and the Hessian of f is positive semidefinite where W cos δ >= W_q sin² δ. Let p be a
/// point, x0 with β(x0) = p its unbent place, and U >= |p - q|, U >= d(q, β(K)). Where the condition holds on a convex
/// set K' that contains x0 and all points of K with f <= U², f lies above its tangent planes on K', and the nearest
/// point is in K': with v = ∇f(x0) / 2 = β'(x0)ᵀ (p - q) and the support function h of K, which is symmetric,
///     d(q, β(K))² >= |p - q|² - 2 (h(v) + v·x0).
/// Where p is close to the nearest point and v normal to K, this is tight to rounding. In the plane of the bend a point
/// with f <= U² lies in the disc of radius |k| U about the query's, in units of 1 / |k|: W >= W_q - |k| U, and where
/// |k| U < W_q, |sin δ| <= |k| U / W_q and cos δ > 0. For |k| U <= 0.56 W_q this implies the condition, as long as only
/// one δ of each point, not δ +- 2π too, counts: the convex case is that of queries half as far from the solid as from
/// the centre of curvature, and of all queries for which the bend is gentle.
class BentDistance {
 public:
  /// Precondition: `primitive` has a bend.
  explicit BentDistance(const Primitive& primitive);

  struct Nearest {
    Enclosure distance;  ///< contains d(x, β(K)), which is 0 in the solid; from 0 where the condition is not proven
    Point point;         ///< near the solid's nearest; proves nothing
  };

  [[nodiscard]] Nearest operator()(const Point& x) const;

  /// A point of K, and the direction from the query to its bent image; both in the primitive's own frame. The direction
  /// has digits beside the surface that the difference of the two has not.
  struct Candidate {
    Proposal point;
    Proposal direction;  ///< of any length
  };

  /// What a candidate proves, however it was found: the closer to the nearest point, the tighter.
  [[nodiscard]] Nearest proven(const Point& x, const Candidate& candidate) const;

  /// d(x, β(K)) >= |x - centre| - the radius of a ball that contains the solid
  [[nodiscard]] double lower_by_sphere(const Point& x) const;

 private:
  struct Query {
    PreciseVector bent, unbent;  ///< in the primitive's own frame
  };

  [[nodiscard]] Query query(const Point& x) const;
  [[nodiscard]] Nearest proven(const Query& q, const Candidate& candidate) const;
  [[nodiscard]] PreciseVector in_solid(const Proposal& point) const;
  [[nodiscard]] Real lower_bound(const Query& q, const Real& upper, const Proposal& direction) const;
  [[nodiscard]] bool is_convex(const Query& q, const Real& upper) const;

  Superquadric superquadric_;
  Bend bend_;
  SuperquadricBounds<Real> bounds_;
  PreciseVector focus_;  ///< from the centre, which is the origin here, because bends act about it
  RigidMotion motion_;
  BendMap<Real> map_;
  // Of the scaled solid in which x0 has to lie:
  PreciseInterval least_w_;
  PreciseInterval angle_;  ///< the largest |γ|
  PreciseInterval radius_;
};

}  // namespace verisq::verify
