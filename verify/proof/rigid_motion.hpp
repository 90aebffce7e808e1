/// Rigid motions in precise interval arithmetic: from the frame of a primitive to that of its model, and back.
#pragma once

#include "verify/proof/certificate.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

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

}  // namespace verisq::verify
