/// Rigid motions, enclosed.
#pragma once

#include "verify/solids/superquadric.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// Rigid motions in precise interval arithmetic: from the frame of a primitive to that of its model, and back.

/// x -> R x + t, enclosed.
struct RigidMotion {
  PreciseMatrix rotation;
  PreciseVector translation;

  RigidMotion(const PreciseMatrix& r, const PreciseVector& t) : rotation(r), translation(t) {}
  /// R is the rotation of the normalised quaternion, enclosed to the rounding error of 127 bits.
  explicit RigidMotion(const Pose& pose);

  /// First `inner`, then this one.
  [[nodiscard]] RigidMotion after(const RigidMotion& inner) const;
  [[nodiscard]] RigidMotion inverse() const;
  [[nodiscard]] PreciseVector operator()(const PreciseVector& x) const;

  /// R^T (x - t)
  [[nodiscard]] PreciseVector local_point(const Point& x) const;
};

/// The exact point, for interval arithmetic. Precondition: finite.
[[nodiscard]] PreciseVector precise(const Point& x);

// The distance of two points, rounded up.

/// |x - y|, rounded up to binary64.
[[nodiscard]] inline double distance_up(const Point& x, const Point& y) {
  return length<Real>(PreciseVector(precise(x) - precise(y))).upper().to_double(Direction::up);
}

}  // namespace verisq::verify
