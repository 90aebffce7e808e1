/// Signed distance of points inside one superquadric.
#pragma once

#include "verify/search/certified_distance.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// For every point of the box q in the solid's frame. Works until the width is at most `tolerance`, or about 1e-14 of
/// the largest semi-axis where that is more, or the search's budget is spent. Precondition: g <= 1 proven on q.
[[nodiscard]] CertifiedDistance interior_distance(const Superquadric& solid, const SuperquadricBounds<Real>& bounds,
                                                  const PreciseVector& q, double tolerance);

}  // namespace verisq::verify
