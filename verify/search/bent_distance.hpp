/// The distance of a point to one bent superquadric by a single certificate, where its square lies above a tangent
/// plane.
#pragma once

#include <optional>

#include "verify/proof/posed_superquadric.hpp"
#include "verify/search/convex_primitive.hpp"
#include "verify/solids/bend.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// Let K be the unbent solid, convex, and β its bend. In the plane of the bend let a point have the polar coordinates W
/// / |k| and γ about the centre of curvature. For β(x), x = (r, s, z) in K, they are W = 1 - k r, γ = k z; for the
/// query q they are W_q, γ_q. The squared distance to the query is
///     f(x) = |β(x) - q|² = (W² + W_q² - 2 W W_q cos(γ - γ_q)) / k² + (s - s_q)².
/// Let p be a point, x0 with β(x0) = p its unbent place, v = ∇f(x0) / 2 = β'(x0)ᵀ (p - q), and Δ = γ_0 - γ_q. W and γ
/// are linear in x. At x0 + (e, δ) in W and γ, f exceeds its tangent plane at x0 by
///     (e² - 2 e W_q u + 2 W_0 W_q E) / k²,  u = cos(Δ + δ) - cos Δ,  E = cos Δ - cos(Δ + δ) - δ sin Δ,
/// and (s - s_0)²: for any e, by at least (2 W_0 E - W_q u²) W_q / k². With half angles this is not negative if
///     W_0 (cos Δ - φ(δ) sin Δ) >= W_q sin²(Δ + δ/2),  φ(δ) = (δ - sin δ) / (1 - cos δ), |δ| < 2π,
/// where φ is odd and rises; |Δ| < π is required, so that only turns away from the query count on the left.
/// Let U >= d(q, β(K)). If this holds for all points of K with f <= U², one of which is nearest,
///     d(q, β(K))² >= |p - q|² - 2 (h(v) + v·x0),
/// h being the support function of K, which is symmetric. If p is close to the nearest point and v normal to K, this is
/// tight to rounding. For points beside the solid Δ is small: only strong bends, or points far outside of the bend,
/// fail. Points beyond an end fail if that end turns away from them by more than about 50°.
class BentDistance {
 public:
  /// Precondition: `primitive` has a bend.
  explicit BentDistance(const Primitive& primitive);

  struct Nearest {
    Enclosure distance;  ///< contains d(x, β(K)), which is 0 in the solid; starts at 0 if the condition is not proven
    Point point;         ///< near the solid's nearest; proves nothing
  };

  [[nodiscard]] Nearest operator()(const Point& x) const;

  /// A point of K, and the direction from the query to its bent image; both in the primitive's own frame. The direction
  /// has digits beside the surface that the difference of the two has not.
  struct Candidate {
    Proposal point;
    Proposal direction;  ///< any length
  };

  /// The bounds that a candidate proves, for any candidate: the closer it is to the nearest point, the tighter.
  [[nodiscard]] Nearest proven(const Point& x, const Candidate& candidate) const;

  /// The closest points, if x is proven to lie outside and the condition above is proven for all of them
  /// (docs/mathematics.md §25). Unique if it is proven strictly. The distance is no wider than the distance of
  /// `operator()`.
  [[nodiscard]] std::optional<ClosestSurfacePoint> closest_point(const Point& x) const;

  /// The same by this candidate alone.
  [[nodiscard]] std::optional<ClosestSurfacePoint> closest_point(const Point& x, const Candidate& candidate) const;

  /// For a certificate: the approximate distance that it proves, and a vector to x from a point near the solid's
  /// nearest, in the primitive's own frame (see Checker). The vector is zero if x seems to lie inside.
  struct Foot {
    Enclosure distance;
    Proposal normal;
  };
  [[nodiscard]] Foot foot(const Point& x) const;

  /// The vector from a point of the model's frame to x, in the primitive's own frame, rounded to nearest.
  [[nodiscard]] Proposal way(const Point& from, const Point& x) const;

  /// The bounds that single evaluations prove.
  [[nodiscard]] const PosedBent& proof() const { return proof_; }

  /// Returns whether all points of a box of the model's frame are proven to lie outside the solid.
  [[nodiscard]] bool excludes(const PreciseVector& box) const;

  /// d(x, β(K)) >= |x - centre| - the radius of a ball that contains the solid
  [[nodiscard]] double lower_by_sphere(const Point& x) const;

 private:
  struct Query {
    PreciseVector bent, unbent;  ///< in the primitive's own frame
  };

  /// The tangent plane of f at x0, which lies below f on all points of K in the required distance.
  struct TangentPlane {
    PreciseVector x0;
    Real distance_lower;  ///< lower bound of d(q, β(K))
  };

  /// A region that contains all points of K as near as `upper`, the nearest among them: at most `reach` from x0 in
  /// every coordinate.
  struct Neighbourhood {
    TangentPlane plane;
    Real upper;
    Real reach;
  };

  [[nodiscard]] Query query(const Point& x) const;
  /// A candidate accurate to about `precision` times the size.
  [[nodiscard]] Candidate proposed(const Query& q, long double precision = 0x1p-60L) const;
  [[nodiscard]] Candidate refined(const Query& q, const Candidate& start) const;
  [[nodiscard]] std::optional<Neighbourhood> neighbourhood(const Query& q, const Candidate& candidate) const;
  [[nodiscard]] std::optional<ClosestSurfacePoint> closest_in(const Query& q,
                                                              const std::optional<Neighbourhood>& found) const;
  [[nodiscard]] Nearest proven(const Query& q, const Candidate& candidate) const;
  /// Returns whether the condition above is proven about the candidate.
  [[nodiscard]] bool is_convex_about(const Query& q, const Candidate& candidate) const;
  [[nodiscard]] PreciseVector image_of(const Candidate& candidate) const;
  [[nodiscard]] PreciseVector in_solid(const Proposal& point) const;
  [[nodiscard]] std::optional<TangentPlane> tangent_plane(const Query& q, const Real& upper,
                                                          const Proposal& direction) const;
  [[nodiscard]] std::optional<Real> reach(const Query& q, const TangentPlane& plane, const Real& upper) const;

  Superquadric superquadric_;
  Bend bend_;
  SuperquadricBounds<Real> bounds_;
  PreciseVector focus_;  ///< from the centre, the origin of this frame, because bends act about it
  RigidMotion motion_;
  BendMap<Real> map_;
  PreciseInterval radius_;
  PosedBent proof_;
};

}  // namespace verisq::verify
