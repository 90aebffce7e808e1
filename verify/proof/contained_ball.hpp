/// Balls that lie in a solid: depths of points.
#pragma once

#include "verify/solids/superquadric.hpp"

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

}  // namespace verisq::verify
