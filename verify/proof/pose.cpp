/// Rotation matrices enclosed, points and directions moved between frames.
#include "verify/proof/pose.hpp"

namespace verisq::verify {

namespace {

PreciseVector exact(const Point& x) {
  return {Real(x[0]), Real(x[1]), Real(x[2])};
}

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

Frame::Frame(const Pose& pose) : rotation_(rotation_matrix(pose.quaternion)), translation_(exact(pose.translation)) {}

PreciseVector Frame::local_point(const Point& x) const {
  return rotation_.transpose() * PreciseVector(exact(x) - translation_);
}

PreciseVector Frame::local_direction(const Proposal& v) const {
  return rotation_.transpose() * precise(v);
}

Proposal Frame::model_direction(const Proposal& v) const {
  return usable(v) ? midpoint(rotation_ * precise(v)) : Proposal{};
}

double distance_up(const Point& x, const Point& y) {
  return length<Real>(PreciseVector(exact(x) - exact(y))).upper().to_double(Direction::up);
}

}  // namespace verisq::verify
