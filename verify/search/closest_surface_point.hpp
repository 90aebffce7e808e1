/// The point of one superquadric's surface that is closest to a given point, as a box that is proven to contain it.
#pragma once

#include "verify/proof/posed_superquadric.hpp"

namespace verisq::verify {

/// In the frame of the model.
struct ClosestSurfacePoint {
  PreciseInterval distance;  ///< contains the signed distance sd
  PreciseVector point;       ///< contains every closest point p
  PreciseVector normal;      ///< where `unique`, the outward unit normal at p, which is the gradient of sd
  bool unique;               ///< proven: there is one closest point, and sd is differentiable at x
};

/// docs/mathematics.md §25. Outside a convex solid there is always one, and what proves the distance proves a ball
/// about it. Inside it is proven where Krawczyk's operator has the only stationary point of a region, and a cover by
/// cones has nothing as close elsewhere; where it is not, `point` holds all points that are not too far, `normal` says
/// nothing.
[[nodiscard]] ClosestSurfacePoint closest_surface_point(const PosedSuperquadric& solid, const Point& x);

}  // namespace verisq::verify
