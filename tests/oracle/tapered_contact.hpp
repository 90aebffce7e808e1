/// Points whose distance to a tapered solid is known by how they are made, by MPFR at 200 bits: a point of the surface,
/// carried there by the map of verisq/model.hpp, and a step along the normal, which is that of the implicit function.
/// Shares nothing with verify/ and kernels/, not even the focus.
#pragma once

#include <random>
#include <verisq/model.hpp>

#include "tests/oracle/reference_distance.hpp"

namespace verisq::oracle {

/// A query and two bounds of its signed distance. Outside both are true because the solid is convex, and lie closer
/// together than binary64 numbers: the half-space of the normal and the point of the surface. Inside `lower` is the
/// distance to the tangent plane with a minus, `upper` 0. A step into a thin solid may lead out of it again: then both
/// are true, and apart.
struct KnownContact {
  Point query;
  Real lower;
  Real upper;
};

/// A point of the surface and the outer unit normal there.
struct SurfacePoint {
  Vector point;
  Vector normal;
};

class TaperedSolid {
 public:
  explicit TaperedSolid(const Primitive& primitive);

  /// In the frame of the model; the point is that to which the ray from the untapered centre along `direction` (not
  /// zero) leads.
  [[nodiscard]] SurfacePoint surface(const Triple<double>& direction) const;

  /// Of a point of the model's frame.
  [[nodiscard]] bool contains(const Vector& point) const { return contains_own(posed_.to_own_frame(point)); }

  /// No two points of the solid are farther apart.
  [[nodiscard]] Real diameter_up() const;

  /// The point of the surface that the ray from the untapered centre along `direction` (not zero) leads to, and a step
  /// of `apart` along the normal, towards the inside where it is negative.
  [[nodiscard]] KnownContact contact(const Triple<double>& direction, double apart) const;

 private:
  [[nodiscard]] bool contains_own(const Vector& own) const;
  /// In the solid's own frame, the normal of any length.
  [[nodiscard]] SurfacePoint own_surface(const Triple<double>& direction) const;

  PosedSolid posed_;  ///< without its taper
  Real k_;
  Real height_;
};

/// Random axes, exponents, pose; ratios of the ends from 1 to `largest_ratio`, either end the larger.
[[nodiscard]] Primitive random_tapered(std::mt19937_64& random, double largest_ratio);

}  // namespace verisq::oracle
