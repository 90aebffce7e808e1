/// Proposes the certificate of a point outside: the closest point of the solid and the normal there.
#pragma once

#include "verify/proof/certificate.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// Closest point x of the solid and a direction v along q - x.
struct Contact {
  Proposal point;
  Proposal normal;
};

/// Solves the optimality conditions x_i + λ n_i(x) = q_i, g(x) = 1 for q outside, in the solid's frame. Nothing is
/// proven here; for q inside or on the surface the result is the radial projection and the normal there. `rough` works
/// in binary64 and takes a fraction of the time of `fast`, which works in long double and is accurate to its rounding
/// for 1e-7 < e < 2 - 1e-8 and e = 2; `thorough` works in 50 digits and some hundred times longer.
[[nodiscard]] Contact rough_contact(const Superquadric& solid, const Proposal& q);
[[nodiscard]] Contact fast_contact(const Superquadric& solid, const Proposal& q);
[[nodiscard]] Contact thorough_contact(const Superquadric& solid, const Proposal& q);

}  // namespace verisq::verify
