/// Superquadrics in their place, bent or not, the balls that they contain, and the bounds that certificates prove about
/// points and triangles.
#pragma once

#include <array>
#include <optional>
#include <variant>

#include "verify/solids/superquadric.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// Proves that a ball lies inside a superquadric: the upper end of the signed distance of a point inside.

/// Radius of a ball about the origin of the solid's own frame that lies inside.
[[nodiscard]] PreciseInterval inner_radius(const Superquadric& solid);

/// Radius, rounded down, of a ball about q that lies inside the solid because a ball about the origin does: exact at
/// the centre of a sphere. It holds for every point of the box q, in the solid's frame. The radius is 0 if nothing is
/// proven.
[[nodiscard]] double central_depth(const Superquadric& solid, const SuperquadricBounds<Real>& bounds,
                                   const PreciseVector& q);

/// Returns whether the ball of the given radius about every point of the box q, in the solid's frame, is proven to lie
/// inside the solid. False if the ball does not lie inside, if the proof would take more than some 50,000 points of the
/// surface, or if it is `interrupted`. Every statement is proven in 127 bits.
[[nodiscard]] bool contains_ball(const Superquadric& solid, const SuperquadricBounds<Real>& bounds,
                                 const PreciseVector& q, double radius, const Hook& interrupted = {});

// Proves that a ball lies inside a bent superquadric by one evaluation at the point where the ball comes closest to the
// boundary.

/// A ball about q with p on its sphere. Places are unbent, in the solid's own frame; stretches are 1 - k r.
struct BentBall {
  PreciseInterval radius;  ///< |p - q|
  PreciseVector query;     ///< β⁻¹(q)
  PreciseInterval query_stretch;
  PreciseVector touching;  ///< c = β⁻¹(p)
  PreciseInterval touching_stretch;
  PreciseVector normal;  ///< β'(c)ᵀ (p - q)
};

/// Returns whether the ball is proven to lie in the bent solid, by docs/mathematics.md §9, "Points inside", which
/// defines the notation. `curvature` is |k|. False for tapers and for exponents above 1.
[[nodiscard]] bool is_bent_ball_contained(const Superquadric& solid, const PreciseInterval& curvature,
                                          const BentBall& ball);

// One posed superquadric K and the bounds that single evaluations prove about a point of the model frame.
//
// The origin of K's own frame is its focus (docs/mathematics.md §18), without a taper its centre.

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
  /// The radius of a sphere about the origin that contains K.
  [[nodiscard]] const PreciseInterval& radius() const { return radius_; }

  /// sd(x) >= |x - origin| - radius
  [[nodiscard]] double lower_by_sphere(const PreciseVector& x) const;
  [[nodiscard]] double lower_by_sphere(const Point& x) const { return lower_by_sphere(precise(x)); }

  /// Returns whether the sphere proves that no point of the box lies in K.
  [[nodiscard]] bool misses(const PreciseVector& box) const { return lower_by_sphere(box) > 0.0; }

  /// sd(x) >= (v·x - h(v)) / |v| for any v, in K's own frame like every v here.
  [[nodiscard]] double lower_by_normal(const Point& x, const Proposal& v) const;

  /// sd(x) <= |x - b|, where b = (x - v) / g(x - v) lies in K.
  [[nodiscard]] double upper_by_normal(const Point& x, const Proposal& v) const;

  /// True proves g(x) <= 1 for all points of the box.
  [[nodiscard]] bool contains(const PreciseVector& x) const;
  [[nodiscard]] bool contains(const Point& x) const { return contains(precise(x)); }

  /// True where the ball is proven to lie in K, by covering it with cones, whatever v is; false once interrupted.
  [[nodiscard]] bool contains_ball_about(const Point& x, double radius, const Proposal& v = {},
                                         const Hook& interrupted = {}) const;

  [[nodiscard]] std::optional<OwnRegion> over(const PreciseVector& centre, const std::array<Real, 3>& half) const;

 private:
  Superquadric superquadric_;
  SuperquadricBounds<Real> bounds_;
  RigidMotion motion_;
  PreciseVector box_;
  PreciseInterval radius_;
};

// One posed and bent superquadric β(K), and the bounds that single evaluations prove about a point of the model frame
// (docs/mathematics.md §9).

/// Has functions of the same names as PosedSuperquadric, which proves the same bounds by them. All vectors are in its
/// own frame. The frame's origin is the centre, also for a tapered solid: bends act about it. An unproven end is
/// infinite, an unproven statement false, for example if the condition of §9 does not hold. Immutable after
/// construction.
class PosedBent {
 public:
  /// Precondition: `primitive` has a bend.
  explicit PosedBent(const Primitive& primitive);

  [[nodiscard]] const Superquadric& superquadric() const { return superquadric_; }
  [[nodiscard]] const SuperquadricBounds<Real>& bounds() const { return bounds_; }
  [[nodiscard]] const RigidMotion& motion() const { return motion_; }
  [[nodiscard]] const PreciseInterval& radius() const { return radius_; }

  [[nodiscard]] double lower_by_sphere(const PreciseVector& x) const;
  [[nodiscard]] double lower_by_sphere(const Point& x) const { return lower_by_sphere(precise(x)); }

  /// By the sphere, or because the box lies beyond the half planes of K's ends, γ = ±|k| a3.
  [[nodiscard]] bool misses(const PreciseVector& box) const;

  /// From below, with p = x - v: d(x, β(K))² >= |v|² - 2 (h(-w) + w·β⁻¹(p)), w = β'(β⁻¹(p))ᵀ (p - x), where f is proven
  /// to lie above its tangent plane on all points of K that are as near as the upper end: d(x, β(K)) <= |x - β(b)|,
  /// where b is β⁻¹(p) scaled to the surface of K.
  [[nodiscard]] Enclosure by_normal(const Point& x, const Proposal& v) const;
  [[nodiscard]] double lower_by_normal(const Point& x, const Proposal& v) const { return by_normal(x, v).lo; }

  /// The upper end alone.
  [[nodiscard]] double upper_by_normal(const Point& x, const Proposal& v) const;

  [[nodiscard]] bool contains(const Point& x) const;

  /// Returns whether the ball is proven to lie in β(K). It lies in β(K) if it is more curved at x - v, |v| = radius,
  /// than the boundary. `v` may have any length.
  [[nodiscard]] bool contains_ball_about(const Point& x, double radius, const Proposal& v, const Hook& = {}) const;

  /// The region before the bend, about the focus. Nothing if the region may meet the half plane in which the angle
  /// jumps.
  [[nodiscard]] std::optional<OwnRegion> over(const PreciseVector& centre, const std::array<Real, 3>& half) const;

  /// How far f rises above its tangent planes at points of K. `margin` is the condition's left side minus its right
  /// side, >= 0, rounded down. `turn` is the largest turn |δ| of the relevant points.
  struct Rise {
    Real margin;
    Real turn;
  };

  /// The rise above tangent planes at `x0`, any point of a box, on all points of K as near to the query as `upper`, a
  /// bound of its distance. Nothing if the rise is not proven.
  [[nodiscard]] std::optional<Rise> rise(const PreciseVector& unbent_query, const PreciseVector& x0,
                                         const Real& upper) const;

 private:
  struct Query {
    PreciseVector bent;  ///< the point in the own frame
    std::optional<PreciseVector> unbent;
  };

  [[nodiscard]] PreciseVector turned(const PreciseVector& v) const;
  [[nodiscard]] PreciseVector turned_back(const PreciseVector& v) const;
  [[nodiscard]] PreciseVector bent(const PreciseVector& unbent) const;
  [[nodiscard]] std::optional<PreciseVector> unbent(const PreciseVector& bent) const;
  [[nodiscard]] PreciseMatrix unbending(const PreciseVector& unbent) const;
  [[nodiscard]] PreciseVector pulled_back(const PreciseVector& v, const PreciseVector& unbent) const;
  [[nodiscard]] Query query(const Point& x) const;
  [[nodiscard]] std::optional<Real> upper(const Query& q, const PreciseVector& x0) const;

  Superquadric superquadric_;
  SuperquadricBounds<Real> bounds_;
  PreciseVector focus_;  ///< about which gauge and support function are
  RigidMotion motion_;
  PreciseInterval k_;
  PreciseInterval cosine_, sine_;  ///< cosine and sine of the direction's angle from x to y
  PreciseInterval angle_;          ///< the largest |γ| of K
  PreciseInterval radius_;         ///< radius of a sphere about the origin that contains β(K)
};

// Bounds that single evaluations prove for the distance of a triangle to one posed superquadric (docs/mathematics.md
// §6).

using PosedPrimitive = std::variant<PosedSuperquadric, PosedBent>;

/// w_1, w_2 of the point t_0 + w_1 (t_1 - t_0) + w_2 (t_2 - t_0).
using Weights = std::array<double, 2>;

/// Returns whether w_1, w_2 >= 0 and w_1 + w_2 <= 1 exactly: the point belongs to the triangle. False for NaN.
[[nodiscard]] bool in_triangle(const Weights& weights);

/// The point with these weights, for corners in any frame.
[[nodiscard]] PreciseVector point_of(const std::array<PreciseVector, 3>& corners, const Weights& weights);

/// A triangle in the frame of one primitive. Its corners are binary64 numbers in the model frame. Here they, and all
/// numbers computed from them, are enclosed to the rounding of 127 bits.
class PosedTriangle {
 public:
  PosedTriangle(const Triangle& triangle, const RigidMotion& motion);

  [[nodiscard]] const std::array<PreciseVector, 3>& corners() const { return corners_; }
  [[nodiscard]] PreciseVector point(const Weights& weights) const { return point_of(corners_, weights); }

 private:
  std::array<PreciseVector, 3> corners_;
};

// Rounded outward to binary64. Distances of triangles are never negative, these bounds may be.

/// d >= min_i u·(t_i - centre) / |u| - radius; u is the triangle's point closest to the centre, found in floating
/// point.
[[nodiscard]] double lower_by_sphere(const PreciseVector& centre, const PreciseInterval& radius,
                                     const Triangle& triangle);
[[nodiscard]] double lower_by_sphere(const auto& solid, const Triangle& triangle) {
  return lower_by_sphere(solid.motion().translation, solid.radius(), triangle);
}
[[nodiscard]] double lower_by_sphere(const auto& solid, const Point& x) {
  return solid.lower_by_sphere(x);
}

/// d >= (min_i v·t_i - h(v)) / |v| for every v: the half-space {v·x <= h(v)} contains the solid, and the convex
/// triangle lies beyond it if its corners do. Minus infinity for a zero or non-finite v.
[[nodiscard]] double lower_by_normal(const PosedSuperquadric& solid, const PosedTriangle& triangle, const Proposal& v);
/// For bent solids, which have no support function, this proves nothing.
[[nodiscard]] double lower_by_normal(const PosedPrimitive& primitive, const Triangle& triangle, const Proposal& v);
[[nodiscard]] double lower_by_normal(const PosedPrimitive& primitive, const Point& x, const Proposal& v);

/// d <= 0 if the point q of the triangle has g(q) <= 1. Else d <= |q - b|, where b = (q - v) / g(q - v) lies in the
/// solid; infinity for a zero or non-finite v.
[[nodiscard]] double upper_by_point(const PosedSuperquadric& solid, const PreciseVector& q, const Proposal& v);

}  // namespace verisq::verify
