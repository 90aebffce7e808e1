/// Proves that no nearest point of a convex surface lies outside a box: a cover of all directions by cones.
#pragma once

#include "verify/numbers/vector.hpp"
#include "verify/proof/superquadric.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// Whether every point of K's surface whose distance from q is least is proven to lie in `box`, that distance being
/// known to lie in `depth`. All in K's own frame; q and the box are of the octant of nonnegative coordinates, but for
/// the z of a tapered solid: coordinates of q that are 0 exactly stand for both signs, and the box must hold both.
/// Precondition: q lies in the interior of K.
///
/// A cone of directions d1, d2, d3 with q + d_i in K has no such point where c·d_i > |c| depth for a vector c >= 0: by
/// the lemma of docs/mathematics.md §5 a ball larger than the depth lies in K there, and what lies strictly between the
/// interior point q and a point of K is no point of the surface. Other cones are divided until the points of the cone
/// at those distances from q lie in the box: with unit vectors u_i along the d_i, their unit vectors are Σ l_i u_i with
/// 1 <= Σ l_i <= 1/m, m the distance from the origin to the triangle of the u_i.
[[nodiscard]] bool nearest_points_lie_in(const Superquadric& solid, const SuperquadricBounds<Real>& bounds,
                                         const PreciseVector& q, const PreciseInterval& depth,
                                         const PreciseVector& box);

}  // namespace verisq::verify
