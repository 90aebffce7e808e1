/// Certificates (docs/mathematics.md §2): a direction proves a lower bound of the signed distance, a point an upper
/// bound.
#pragma once

#include "verify/proof/proposals.hpp"
#include "verify/proof/superquadric.hpp"

namespace verisq::verify {

/// sd(q) >= (v·q - h(v)) / |v| for every v, because K lies in the half-space {v·x <= h(v)}; rounded down. Minus
/// infinity for a zero or non-finite v. The bound holds for every point of the box q, given in the solid's frame.
[[nodiscard]] double lower_bound(const SuperquadricBounds<Real>& solid, const PreciseVector& q, const Proposal& v);

/// sd(q) <= |q - b| for every b in K; b = x / g(x) with g(x) rounded up has g(b) <= 1 and lies beside the surface.
/// Rounded up. The centre takes the place of a zero or non-finite x.
[[nodiscard]] double upper_bound(const SuperquadricBounds<Real>& solid, const PreciseVector& q, const Proposal& x);
/// The same for an x known to lie in a box.
[[nodiscard]] double upper_bound_at(const SuperquadricBounds<Real>& solid, const PreciseVector& q,
                                    const PreciseVector& x);

/// The exact vector, for interval arithmetic. Precondition: finite.
[[nodiscard]] PreciseVector precise(const Proposal& v);

/// A floating-point point near the middle of a thin box.
[[nodiscard]] Proposal midpoint(const PreciseVector& v);

/// Whether every coordinate is finite and one of them is not zero.
[[nodiscard]] bool usable(const Proposal& v);

}  // namespace verisq::verify
