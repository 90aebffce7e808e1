/// Half-spaces and spheres from below, a point of the triangle from above, in 127-bit interval arithmetic.
#include "verify/proof/triangle_certificate.hpp"

#include <algorithm>

#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

/// min_i v·t_i, rounded down.
PreciseInterval least_along(const PreciseVector& v, const std::array<PreciseVector, 3>& corners) {
  const auto along_v = [&](std::size_t i) { return v.dot(corners[i]).lower(); };
  return PreciseInterval(std::min({along_v(0), along_v(1), along_v(2)}));
}

}  // namespace

bool in_triangle(const Weights& weights) {
  // The sum rounded up is above 1 exactly if the sum is, because 1 is a number of 127 bits.
  return weights[0] >= 0.0 && weights[1] >= 0.0 && add(Real(weights[0]), Real(weights[1]), Direction::up) <= Real(1);
}

PreciseVector point_of(const std::array<PreciseVector, 3>& corners, const Weights& weights) {
  const PreciseVector first = corners[1] - corners[0];
  const PreciseVector second = corners[2] - corners[0];
  return corners[0] + first * PreciseInterval(Real(weights[0])) + second * PreciseInterval(Real(weights[1]));
}

PosedTriangle::PosedTriangle(const Triangle& triangle, const RigidMotion& motion)
    : corners_{motion.local_point(triangle[0]), motion.local_point(triangle[1]), motion.local_point(triangle[2])} {}

double lower_by_sphere(const PreciseVector& centre, const PreciseInterval& radius, const Triangle& triangle) {
  std::array<PreciseVector, 3> from_centre;  // distances to the centre need no rotation
  for (std::size_t i = 0; i < 3; ++i) {
    from_centre[i] = precise(triangle[i]) - centre;
  }
  const Proposal u =
      proposed::closest_to_origin({midpoint(from_centre[0]), midpoint(from_centre[1]), midpoint(from_centre[2])});
  if (!usable(u)) return (-radius).lower().to_double(Direction::down);
  const PreciseVector direction = precise(u);
  const PreciseInterval distance = least_along(direction, from_centre) / length<Real>(direction);
  return (distance - radius).lower().to_double(Direction::down);
}

double lower_by_normal(const PosedSuperquadric& solid, const PosedTriangle& triangle, const Proposal& v) {
  if (!usable(v)) return -infinity;
  const PreciseVector direction = precise(v);
  const PreciseInterval support(solid.bounds().support_up(direction));
  const PreciseInterval bound = (least_along(direction, triangle.corners()) - support) / length<Real>(direction);
  return bound.lower().to_double(Direction::down);
}

double lower_by_normal(const PosedPrimitive& primitive, const Triangle& triangle, const Proposal& v) {
  const auto* const solid = std::get_if<PosedSuperquadric>(&primitive);
  return solid != nullptr ? lower_by_normal(*solid, PosedTriangle(triangle, solid->motion()), v) : -infinity;
}

double lower_by_normal(const PosedPrimitive& primitive, const Point& x, const Proposal& v) {
  return std::visit([&](const auto& solid) { return solid.lower_by_normal(x, v); }, primitive);
}

double upper_by_point(const PosedSuperquadric& solid, const PreciseVector& q, const Proposal& v) {
  if (solid.bounds().gauge_up(q) <= Real(1)) return 0.0;
  if (!usable(v)) return infinity;
  return upper_bound_at(solid.bounds(), q, PreciseVector(q - precise(v)));
}

}  // namespace verisq::verify
