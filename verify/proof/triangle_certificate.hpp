/// Bounds that single evaluations prove for the distance of a triangle to one posed superquadric (docs/mathematics.md
/// §6).
#pragma once

#include <array>
#include <variant>

#include "verify/proof/posed_superquadric.hpp"
#include "verisq/mesh.hpp"

namespace verisq::verify {

using PosedPrimitive = std::variant<PosedSuperquadric, PosedBent>;

/// w_1, w_2 of the point t_0 + w_1 (t_1 - t_0) + w_2 (t_2 - t_0).
using Weights = std::array<double, 2>;

/// Returns whether w_1, w_2 >= 0 and w_1 + w_2 <= 1 exactly: the point belongs to the triangle. False for NaN.
[[nodiscard]] bool in_triangle(const Weights& weights);

/// The point with these weights, for corners in any frame.
[[nodiscard]] PreciseVector point_of(const std::array<PreciseVector, 3>& corners, const Weights& weights);

/// A triangle in the frame of one primitive. Its corners are binary64 numbers in the model frame. Here they, and all
/// numbers computed from them, are enclosed to the rounding of 127 bits.
class PosedTriangle {
 public:
  PosedTriangle(const Triangle& triangle, const RigidMotion& motion);

  [[nodiscard]] const std::array<PreciseVector, 3>& corners() const { return corners_; }
  [[nodiscard]] PreciseVector point(const Weights& weights) const { return point_of(corners_, weights); }

 private:
  std::array<PreciseVector, 3> corners_;
};

// Rounded outward to binary64. Distances of triangles are never negative, these bounds may be.

/// d >= min_i u·(t_i - centre) / |u| - radius; u is the triangle's point closest to the centre, found in floating
/// point.
[[nodiscard]] double lower_by_sphere(const PreciseVector& centre, const PreciseInterval& radius,
                                     const Triangle& triangle);
[[nodiscard]] double lower_by_sphere(const auto& solid, const Triangle& triangle) {
  return lower_by_sphere(solid.motion().translation, solid.radius(), triangle);
}
[[nodiscard]] double lower_by_sphere(const auto& solid, const Point& x) {
  return solid.lower_by_sphere(x);
}

/// d >= (min_i v·t_i - h(v)) / |v| for every v: the half-space {v·x <= h(v)} contains the solid, and the convex
/// triangle lies beyond it if its corners do. Minus infinity for a zero or non-finite v.
[[nodiscard]] double lower_by_normal(const PosedSuperquadric& solid, const PosedTriangle& triangle, const Proposal& v);
/// For bent solids, which have no support function, this proves nothing.
[[nodiscard]] double lower_by_normal(const PosedPrimitive& primitive, const Triangle& triangle, const Proposal& v);
[[nodiscard]] double lower_by_normal(const PosedPrimitive& primitive, const Point& x, const Proposal& v);

/// d <= 0 if the point q of the triangle has g(q) <= 1. Else d <= |q - b|, where b = (q - v) / g(q - v) lies in the
/// solid; infinity for a zero or non-finite v.
[[nodiscard]] double upper_by_point(const PosedSuperquadric& solid, const PreciseVector& q, const Proposal& v);

}  // namespace verisq::verify
