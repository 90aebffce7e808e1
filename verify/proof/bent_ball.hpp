/// Proves that a ball lies inside a bent superquadric by one look at the point where it comes closest to the boundary.
#pragma once

#include "verify/proof/superquadric.hpp"

namespace verisq::verify {

/// A ball about q with p on its sphere. Places are unbent, in the solid's own frame; stretches are 1 - k r.
struct BentBall {
  PreciseInterval radius;  ///< |p - q|
  PreciseVector query;     ///< β⁻¹(q)
  PreciseInterval query_stretch;
  PreciseVector touching;  ///< c = β⁻¹(p)
  PreciseInterval touching_stretch;
  PreciseVector normal;  ///< β'(c)ᵀ (p - q)
};

/// Whether it is proven to lie in the bent solid, as docs/mathematics.md §9 says under "Points inside", where the
/// notation is from. `curvature` is |k|. False for tapers and for exponents above 1.
[[nodiscard]] bool is_bent_ball_contained(const Superquadric& solid, const PreciseInterval& curvature,
                                          const BentBall& ball);

}  // namespace verisq::verify
