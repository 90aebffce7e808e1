/// Signed distance of points outside one superquadric.
#pragma once

#include "verify/search/certified_distance.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// For every point of the box q in the solid's frame, at most `tolerance` wide or to the rounding of the result. Valid
/// for points inside too, where the lower end is that of the nearest plane along the ray from the centre, and the upper
/// end is positive.
[[nodiscard]] CertifiedDistance exterior_distance(const Superquadric& solid, const SuperquadricBounds<Real>& bounds,
                                                  const PreciseVector& q, double tolerance);

}  // namespace verisq::verify
