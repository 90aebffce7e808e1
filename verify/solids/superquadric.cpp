/// This file implements superquadric.hpp.
#include "verify/solids/superquadric.hpp"

#include <algorithm>
#include <cmath>

#include "verisq/enclosure.hpp"

namespace verisq::verify {

Real bound_of_power(const Real& base, const Real& exponent, Direction direction) {
  return power(base, exponent, direction);
}

template class SuperquadricBounds<Real>;

PreciseVector focus(const Superquadric& superquadric) {
  return {0, 0, -(TaperNumbers<Real>(superquadric.taper).k * PreciseInterval(Real(superquadric.semi_axes[2])))};
}

PreciseVector precise(const Proposal& v) {
  return {Real(v[0]), Real(v[1]), Real(v[2])};
}

Proposal midpoint(const PreciseVector& v) {
  const auto middle = [](const PreciseInterval& x) {
    return 0.5L * x.lower().to_long_double() + 0.5L * x.upper().to_long_double();
  };
  return {middle(v[0]), middle(v[1]), middle(v[2])};
}

bool usable(const Proposal& v) {
  return std::ranges::all_of(v, [](long double c) { return std::isfinite(c); }) &&
         std::ranges::any_of(v, [](long double c) { return c != 0.0L; });
}

double lower_bound(const SuperquadricBounds<Real>& solid, const PreciseVector& q, const Proposal& v) {
  if (!usable(v)) return -infinity;
  const PreciseVector direction = precise(v);
  const PreciseInterval support(solid.support_up(direction));
  const PreciseInterval bound = (direction.dot(q) - support) / length<Real>(direction);
  return bound.lower().to_double(Direction::down);
}

double upper_bound(const SuperquadricBounds<Real>& solid, const PreciseVector& q, const Proposal& x) {
  return upper_bound_at(solid, q, usable(x) ? precise(x) : precise(Proposal{}));
}

double upper_bound_at(const SuperquadricBounds<Real>& solid, const PreciseVector& q, const PreciseVector& x) {
  const Real gauge = solid.gauge_up(x);
  const PreciseVector b = gauge > Real(0) ? PreciseVector(x / PreciseInterval(gauge)) : x;
  return length<Real>(PreciseVector(q - b)).upper().to_double(Direction::up);
}

namespace {

/// Rotation matrix of q/|q|: homogeneous of degree 2 in q, divided by |q|^2, so that no square root is needed.
PreciseMatrix rotation_matrix(const std::array<double, 4>& quaternion) {
  const PreciseInterval w = Real(quaternion[0]);
  const PreciseInterval x = Real(quaternion[1]);
  const PreciseInterval y = Real(quaternion[2]);
  const PreciseInterval z = Real(quaternion[3]);
  const PreciseInterval one(1);
  const PreciseInterval s = PreciseInterval(2) / (square(w) + square(x) + square(y) + square(z));
  return {{one - s * (square(y) + square(z)), s * (x * y - w * z), s * (x * z + w * y)},
          {s * (x * y + w * z), one - s * (square(x) + square(z)), s * (y * z - w * x)},
          {s * (x * z - w * y), s * (y * z + w * x), one - s * (square(x) + square(y))}};
}

}  // namespace

RigidMotion::RigidMotion(const Pose& pose)
    : rotation(rotation_matrix(pose.quaternion)), translation(precise(pose.translation)) {}

RigidMotion RigidMotion::after(const RigidMotion& inner) const {
  return {rotation * inner.rotation, (*this)(inner.translation)};
}

RigidMotion RigidMotion::inverse() const {
  return {rotation.transpose(), -(rotation.transpose() * translation)};
}

PreciseVector RigidMotion::operator()(const PreciseVector& x) const {
  return rotation * x + translation;
}

PreciseVector RigidMotion::local_point(const Point& x) const {
  return rotation.transpose() * PreciseVector(precise(x) - translation);
}

PreciseVector precise(const Point& x) {
  return {Real(x[0]), Real(x[1]), Real(x[2])};
}

}  // namespace verisq::verify
