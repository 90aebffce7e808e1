/// RigidMotion and bounds of one superquadric together.
#include "verify/proof/posed_superquadric.hpp"

#include "verify/proof/contained_ball.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

/// Its faces lie where the support function says.
PreciseVector box_about(const SuperquadricBounds<Real>& bounds) {
  const auto reach = [&](int x, int y, int z) { return bounds.support_up(PreciseVector(x, y, z)); };
  const auto between = [](const Real& below, const Real& above) { return PreciseInterval(-below, above); };
  return {between(reach(-1, 0, 0), reach(1, 0, 0)), between(reach(0, -1, 0), reach(0, 1, 0)),
          between(reach(0, 0, -1), reach(0, 0, 1))};
}

RigidMotion from_own_frame(const Primitive& primitive) {
  RigidMotion motion(primitive.pose);
  if (is_tapered(primitive.superquadric)) motion.translation = motion(focus(primitive.superquadric));
  return motion;
}

}  // namespace

PosedSuperquadric::PosedSuperquadric(const Primitive& primitive)
    : superquadric_(primitive.superquadric),
      bounds_(primitive.superquadric),
      motion_(from_own_frame(primitive)),
      box_(box_about(bounds_)),
      radius_(length<Real>(box_).upper()) {}

double PosedSuperquadric::lower_by_sphere(const PreciseVector& x) const {
  return (length<Real>(PreciseVector(x - motion_.translation)) - radius_).lower().to_double(Direction::down);
}

double PosedSuperquadric::lower_by_normal(const Point& x, const Proposal& v) const {
  return lower_bound(bounds_, motion_.local_point(x), v);
}

double PosedSuperquadric::upper_by_normal(const Point& x, const Proposal& v) const {
  if (!usable(v)) return infinity;
  const PreciseVector q = motion_.local_point(x);
  return upper_bound_at(bounds_, q, PreciseVector(q - precise(v)));
}

bool PosedSuperquadric::contains(const Point& x) const {
  return bounds_.gauge(motion_.local_point(x)).upper() <= Real(1);
}

bool PosedSuperquadric::contains_ball_about(const Point& x, double radius, const Proposal& /*v*/) const {
  return contains_ball(superquadric_, bounds_, motion_.local_point(x), radius);
}

std::optional<OwnRegion> PosedSuperquadric::over(const PreciseVector& centre, const std::array<Real, 3>& half) const {
  const PreciseMatrix to_own = motion_.rotation.transpose();
  const PreciseVector own = to_own * (centre - motion_.translation);
  return OwnRegion{own, own + to_own * box_of(half), to_own};
}

}  // namespace verisq::verify
