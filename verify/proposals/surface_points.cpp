/// Where rays leave a superquadric, gradients of its gauge, the foot of a triangle, the root of a support function.
#include <cmath>

#include "verify/proof/proposals.hpp"
#include "verify/proposals/boundary.hpp"
#include "verify/proposals/support_root.hpp"
#include "verify/proposals/triangle.hpp"

namespace verisq::verify::proposed {

long double exit(const Superquadric& solid, const Proposal& q, const Proposal& w, long double level) {
  return Boundary<long double>(solid).exit(q, w, level);
}

Proposal gradient(const Superquadric& solid, const Proposal& x) {
  using Vector = std::array<double, 3>;
  const Boundary<double> boundary(solid);
  Vector folded{static_cast<double>(x[0]), static_cast<double>(x[1]), static_cast<double>(x[2])};
  for (std::size_t i = 0; i < (is_tapered(solid) ? 2 : 3); ++i) folded[i] = std::fabs(folded[i]);
  const Vector w = boundary.normal(folded);
  const double scale = boundary.gauge(folded) / dot(w, folded);  // Euler: g is homogeneous
  Proposal result;
  for (std::size_t i = 0; i < 3; ++i) result[i] = std::copysign(scale * w[i], x[i]);
  if (is_tapered(solid)) result[2] = scale * w[2];
  return result;
}

Proposal closest_to_origin(const std::array<Proposal, 3>& corners) {
  return verify::closest_to_origin(corners[0], corners[1], corners[2]);
}

long double support_root(long double section, long double height, long double k, long double q) {
  return near_root_of_support(section, height, k, q);
}

}  // namespace verisq::verify::proposed
