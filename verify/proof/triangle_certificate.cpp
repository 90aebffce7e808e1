/// Half-spaces and spheres from below, a point of the triangle from above, in 127-bit interval arithmetic.
#include "verify/proof/triangle_certificate.hpp"

#include <algorithm>

#include "verify/proof/triangle.hpp"
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
  // The sum rounded up is above 1 exactly if the sum is, because 1 is a binary64 number.
  return weights[0] >= 0.0 && weights[1] >= 0.0 && add(weights[0], weights[1], Direction::up) <= 1.0;
}

PosedTriangle::PosedTriangle(const Triangle& triangle, const RigidMotion& motion)
    : corners_{motion.local_point(triangle[0]), motion.local_point(triangle[1]), motion.local_point(triangle[2])} {}

PreciseVector PosedTriangle::point(const Weights& weights) const {
  const PreciseVector first = corners_[1] - corners_[0];
  const PreciseVector second = corners_[2] - corners_[0];
  return corners_[0] + first * PreciseInterval(Real(weights[0])) + second * PreciseInterval(Real(weights[1]));
}

double lower_by_sphere(const PosedSuperquadric& solid, const Triangle& triangle) {
  std::array<PreciseVector, 3> from_centre;  // distances to the centre need no rotation
  for (std::size_t i = 0; i < 3; ++i) {
    from_centre[i] = precise(triangle[i]) - solid.motion().translation;
  }
  const Proposal u = closest_to_origin(midpoint(from_centre[0]), midpoint(from_centre[1]), midpoint(from_centre[2]));
  if (!usable(u)) return (-solid.radius()).lower().to_double(Direction::down);
  const PreciseVector direction = precise(u);
  const PreciseInterval distance = least_along(direction, from_centre) / length<Real>(direction);
  return (distance - solid.radius()).lower().to_double(Direction::down);
}

double lower_by_normal(const PosedSuperquadric& solid, const PosedTriangle& triangle, const Proposal& v) {
  if (!usable(v)) return -infinity;
  const PreciseVector direction = precise(v);
  const PreciseInterval support(solid.bounds().support_up(direction));
  const PreciseInterval bound = (least_along(direction, triangle.corners()) - support) / length<Real>(direction);
  return bound.lower().to_double(Direction::down);
}

double upper_by_point(const PosedSuperquadric& solid, const PreciseVector& q, const Proposal& v) {
  if (solid.bounds().gauge_up(q) <= Real(1)) return 0.0;
  if (!usable(v)) return infinity;
  return upper_bound_at(solid.bounds(), q, PreciseVector(q - precise(v)));
}

}  // namespace verisq::verify
