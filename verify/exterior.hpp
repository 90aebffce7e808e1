/// Proposes the certificate of a point outside: the closest point of the solid and the normal there.
#pragma once

#include "verify/certificate.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// Closest point x of the solid and a direction v along q - x.
struct Contact {
  Proposal point;
  Proposal normal;
};

/// Solves the optimality conditions x_i + λ n_i(x) = q_i, g(x) = 1 for q outside, in the solid's frame, to nearly the
/// precision of long double. Nothing is proven here; for q inside or within 1e-16 of the surface the
/// result is the radial projection and the normal there.
[[nodiscard]] Contact closest_contact(const Superquadric& solid, const Proposal& q);

}  // namespace verisq::verify
