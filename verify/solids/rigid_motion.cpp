/// This file implements rigid_motion.hpp.
#include "verify/solids/rigid_motion.hpp"

namespace verisq::verify {

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
