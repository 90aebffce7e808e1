/// The point of a primitive's surface that is nearest to a point.
#pragma once

#include "verify/numbers/vector.hpp"
#include "verify/proof/posed_superquadric.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

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
