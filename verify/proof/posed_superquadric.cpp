/// RigidMotion and bounds of one superquadric together.
#include "verify/proof/posed_superquadric.hpp"

#include "verify/proof/contained_ball.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

/// Half the diagonal of the box of the semi-axes.
PreciseInterval half_diagonal(const std::array<double, 3>& semi_axes) {
  return length<Real>(PreciseVector(Real(semi_axes[0]), Real(semi_axes[1]), Real(semi_axes[2])));
}

}  // namespace

PosedSuperquadric::PosedSuperquadric(const Primitive& primitive)
    : superquadric_(primitive.superquadric),
      bounds_(primitive.superquadric),
      motion_(primitive.pose),
      radius_(half_diagonal(primitive.superquadric.semi_axes)) {}

double PosedSuperquadric::lower_by_sphere(const Point& x) const {
  return (length<Real>(motion_.local_point(x)) - radius_).lower().to_double(Direction::down);
}

double PosedSuperquadric::lower_by_normal(const Point& x, const Proposal& v) const {
  return lower_bound(bounds_, motion_.local_point(x), v);
}

double PosedSuperquadric::upper_by_normal(const Point& x, const Proposal& v) const {
  if (!usable(v)) return infinity;
  const PreciseVector q = motion_.local_point(x);
  return upper_bound_at(bounds_, q, PreciseVector(q - precise(v)));
}

bool PosedSuperquadric::excludes(const Point& x) const {
  return lower_by_sphere(x) > 0.0 || bounds_.gauge(motion_.local_point(x)).lower() > Real(1);
}

bool PosedSuperquadric::contains(const Point& x) const {
  return bounds_.gauge(motion_.local_point(x)).upper() <= Real(1);
}

bool PosedSuperquadric::contains_ball_about(const Point& x, double radius) const {
  return contains_ball(superquadric_, bounds_, motion_.local_point(x), radius);
}

}  // namespace verisq::verify
