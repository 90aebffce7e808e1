/// Frame and proofs of one superquadric together.
#include "verify/solid.hpp"

#include "verify/contact.hpp"
#include "verify/exterior.hpp"
#include "verify/interior.hpp"

namespace verisq::verify {

namespace {

/// Half the diagonal of the box of the semi-axes.
PreciseInterval half_diagonal(const std::array<double, 3>& semi_axes) {
  return length<Real>(PreciseVector(Real(semi_axes[0]), Real(semi_axes[1]), Real(semi_axes[2])));
}

}  // namespace

Solid::Solid(const Primitive& primitive)
    : superquadric_(primitive.superquadric),
      bounds_(primitive.superquadric),
      frame_(primitive.pose),
      radius_(half_diagonal(primitive.superquadric.semi_axes)) {}

CertifiedDistance Solid::signed_distance(const Point& x, double tolerance) const {
  const PreciseVector q = frame_.local_point(x);
  CertifiedDistance result = exterior_distance(superquadric_, bounds_, q);
  if (result.distance.lo <= 0.0 && bounds_.gauge(q).upper() <= Real(1)) {
    const CertifiedDistance inside = interior_distance(superquadric_, bounds_, q, tolerance);
    result.distance.hi = inside.distance.hi;
    if (inside.distance.lo > result.distance.lo) result = inside;
  }
  return result;
}

double Solid::sphere_bound(const Point& x) const {
  return (length<Real>(frame_.local_point(x)) - radius_).lower().to_double(Direction::down);
}

double Solid::ray_clearance(const Point& x, const Proposal& u) const {
  const PreciseVector q = frame_.local_point(x);
  const PreciseVector v = frame_.local_direction(u);
  const PreciseInterval squared_length = square(v[0]) + square(v[1]) + square(v[2]);
  return ((bounds_.support(v) - v.dot(q)) / squared_length).upper().to_double(Direction::up);
}

bool Solid::separated(const Point& x, const Proposal& u, double s) const {
  const PreciseVector q = frame_.local_point(x) + frame_.local_direction(u) * PreciseInterval(Real(s));
  if ((length<Real>(q) - radius_).lower() > Real(0)) return true;
  return lower_bound(bounds_, q, fast_contact(superquadric_, midpoint(q)).normal) > 0.0;
}

bool Solid::excludes(const Point& x) const {
  const PreciseVector q = frame_.local_point(x);
  return (length<Real>(q) - radius_).lower() > Real(0) || bounds_.gauge(q).lower() > Real(1);
}

PreciseVector Solid::bounding_box() const {
  PreciseVector box;
  for (Eigen::Index i = 0; i < 3; ++i) {
    PreciseInterval half(0);
    for (Eigen::Index j = 0; j < 3; ++j) {
      half +=
          abs(frame_.rotation()(i, j)) * PreciseInterval(Real(superquadric_.semi_axes[static_cast<std::size_t>(j)]));
    }
    box[i] = frame_.origin()[i] + PreciseInterval(-half.upper(), half.upper());
  }
  return box;
}

}  // namespace verisq::verify
