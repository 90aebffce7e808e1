/// Proves that a ball lies inside a superquadric: the upper end of the signed distance of a point inside.
#pragma once

#include "verify/proof/superquadric.hpp"

namespace verisq::verify {

/// Radius of a ball about the origin of the solid's own frame that lies inside.
[[nodiscard]] PreciseInterval inner_radius(const Superquadric& solid);

/// Radius, rounded down, of a ball about q that lies inside the solid because one about the origin does: exact at the
/// centre of a sphere. For every point of the box q, in the solid's frame; 0 where nothing is proven.
[[nodiscard]] double central_depth(const Superquadric& solid, const SuperquadricBounds<Real>& bounds,
                                   const PreciseVector& q);

/// Whether the ball of the given radius about every point of the box q, in the solid's frame, is proven to lie inside
/// the solid; false when it does not, or when the proof would take more than some 50,000 points of the surface. Every
/// statement is proven in 127 bits.
[[nodiscard]] bool contains_ball(const Superquadric& solid, const SuperquadricBounds<Real>& bounds,
                                 const PreciseVector& q, double radius);

}  // namespace verisq::verify
