/// Distances of points to one convex primitive, outside and inside, and the point of its surface that is nearest.
#pragma once

#include <array>

#include "verify/numbers/vector.hpp"
#include "verify/proof/posed_superquadric.hpp"
#include "verify/search/certified_distance.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// Signed distance of points outside one superquadric.

/// The distance for every point of the box q in the solid's frame, at most `tolerance` wide or to the rounding of the
/// result. It is valid for points inside, too. There the lower end is that of the nearest plane along the ray from the
/// centre, and the upper end is positive.
[[nodiscard]] PrimitiveDistance exterior_distance(const Superquadric& solid, const SuperquadricBounds<Real>& bounds,
                                                  const PreciseVector& q, double tolerance);

// Encloses the depth of a point by a polyhedron inscribed in the solid and refined where it comes closest.

struct Depth {
  double lower;                  ///< proven: the ball of this radius about q lies in the solid
  double upper;                  ///< not proven: distance of q to the closest tangent plane found
  std::array<double, 3> normal;  ///< of that plane, in the octant: the direction that certifies the other end
};

/// When to stop.
struct DepthGoal {
  double tolerance;  ///< for upper - lower
  double known;      ///< a lower bound that the caller has proven
  int budget;        ///< points of the surface to prove at most
};

// Signed distance of points inside one superquadric.

/// The distance for every point of the box q in the solid's frame. Works until the width is at most `tolerance`, or
/// about 1e-14 of the largest semi-axis if that is more, or the search's budget is spent. Precondition: g <= 1 proven
/// on q.
[[nodiscard]] PrimitiveDistance interior_distance(const Superquadric& solid, const SuperquadricBounds<Real>& bounds,
                                                  const PreciseVector& q, double tolerance);

// One posed superquadric, ready for searches and their proofs.

class ConvexPrimitive {
 public:
  explicit ConvexPrimitive(const Primitive& primitive) : proof_(primitive) {}

  /// Signed distance of a point of the model frame.
  [[nodiscard]] PrimitiveDistance signed_distance(const Point& x, double tolerance) const;

  /// A direction of the solid's frame in the model's, to nearest. Zero if v is not usable.
  [[nodiscard]] Proposal model_direction(const Proposal& v) const {
    return usable(v) ? midpoint(proof_.motion().rotation * precise(v)) : Proposal{};
  }

  /// The bounds that need no search.
  [[nodiscard]] const PosedSuperquadric& proof() const { return proof_; }

  /// How far along x + s u the supporting plane of normal u lies: beyond the returned s (rounded up) every point of the
  /// ray is outside. Precondition: u is usable.
  [[nodiscard]] double ray_clearance(const Point& x, const Proposal& u) const;

  /// Returns whether x + s u is proven to lie outside, at a positive distance.
  [[nodiscard]] bool separated(const Point& x, const Proposal& u, double s) const;

  /// Returns whether x is proven to lie outside.
  [[nodiscard]] bool excludes(const Point& x) const {
    return proof_.lower_by_sphere(x) > 0.0 || proof_.bounds().gauge(proof_.motion().local_point(x)).lower() > Real(1);
  }

  /// The corners of the bounding box of the solid's posed box, along each axis of the model frame.
  [[nodiscard]] PreciseVector bounding_box() const;

 private:
  PosedSuperquadric proof_;
};

// Proves that no nearest point of a convex surface lies outside a box: a cover of all directions by cones.

/// Returns whether every point of K's surface whose distance from q is least is proven to lie in `box`; that distance
/// is known to lie in `depth`. All vectors are in K's own frame. q and the box lie in the octant of nonnegative
/// coordinates, but for the z of a tapered solid. Coordinates of q that are exactly 0 represent both signs, and the box
/// must contain both. Precondition: q lies in the interior of K.
///
/// A cone of directions d1, d2, d3 with q + d_i in K has no such point if c·d_i > |c| depth for a vector c >= 0. By the
/// lemma of docs/mathematics.md §5 a ball larger than the depth lies in K there, and a point strictly between the
/// interior point q and a point of K is no point of the surface. Other cones are divided until the points of the cone
/// at those distances from q lie in the box. With unit vectors u_i along the d_i, their unit vectors are Σ l_i u_i with
/// 1 <= Σ l_i <= 1/m, m the distance from the origin to the triangle of the u_i.
[[nodiscard]] bool nearest_points_lie_in(const Superquadric& solid, const SuperquadricBounds<Real>& bounds,
                                         const PreciseVector& q, const PreciseInterval& depth,
                                         const PreciseVector& box);

// The point of one superquadric's surface that is closest to a given point, as a box that is proven to contain it.

/// In the frame of the model.
struct ClosestSurfacePoint {
  PreciseInterval distance;  ///< contains the signed distance sd
  PreciseVector point;       ///< contains every closest point p
  PreciseVector normal;      ///< the outward unit normal at p, if `unique`; it is the gradient of sd
  bool unique;               ///< proven: there is one closest point, and sd is differentiable at x
};

/// docs/mathematics.md §25. Outside a convex solid there is always one closest point, and the proof of the distance
/// proves a ball about it. Inside it is proven if Krawczyk's operator proves the only stationary point of a region, and
/// a cover by cones proves that no point elsewhere is as close. If it is not proven, `point` contains all points that
/// are not too far, and `normal` is meaningless.
[[nodiscard]] ClosestSurfacePoint closest_surface_point(const PosedSuperquadric& solid, const Point& x);

}  // namespace verisq::verify
