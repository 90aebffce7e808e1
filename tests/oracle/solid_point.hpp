/// A posed superquadric as the variables of a distance program, and what its points and directions prove at 200 bits.
#pragma once

#include <vector>

#include "tests/oracle/reference_distance.hpp"

namespace verisq::oracle {

template <class Number>
[[nodiscard]] Triple<Number> converted(const Vector& a) {
  return {static_cast<Number>(a[0]), static_cast<Number>(a[1]), static_cast<Number>(a[2])};
}

/// The three semi-axes as vectors of the common frame, times `sign`.
template <class Number>
[[nodiscard]] Triple<Triple<Number>> solid_axes(const PosedSolid& solid, const Number& sign) {
  Triple<Triple<Number>> axes;
  for (std::size_t i = 0; i < 3; ++i) {
    Vector tip{Real(0), Real(0), Real(0)};
    tip[i] = solid.norm().semi_axes()[i];
    axes[i] = scaled<Number>(converted<Number>(difference(solid.from_own_frame(tip), solid.centre())), sign);
  }
  return axes;
}

/// What all roundings at 200 bits together stay far below: each result is a handful of norms and dot products, whose
/// relative errors do not add up to 2^-190 of the magnitudes involved.
[[nodiscard]] inline Real rounding_at_200_bits(const PosedSolid& solid) {
  return ldexp(length(solid.centre()) + solid.largest_semi_axis(), -170);
}

/// The point of the solid, in the common frame, with the coordinates variables[first + i] in units of the semi-axes;
/// drawn to the boundary where they leave the solid.
[[nodiscard]] inline Vector solid_point(const PosedSolid& solid, const std::vector<Real>& variables,
                                        std::size_t first) {
  Vector x;
  for (std::size_t i = 0; i < 3; ++i) x[i] = variables[first + i] * solid.norm().semi_axes()[i];
  const Real gauge = solid.norm().gauge(x);
  return solid.from_own_frame(gauge > 1 ? scaled<Real>(x, 1 / gauge) : x);
}

/// Proven, by a margin beyond the roundings.
[[nodiscard]] inline bool contains(const PosedSolid& solid, const Vector& point) {
  const Vector& axes = solid.norm().semi_axes();
  const Real magnitude = length(point) + length(solid.centre());
  const Real slack = ldexp(1 + magnitude / *std::min_element(axes.begin(), axes.end()), -170);
  return solid.norm().gauge(solid.to_own_frame(point)) < 1 - slack;
}

/// h(v) for v of the common frame; the solid is symmetric, so h(-v) as well.
[[nodiscard]] inline Real support(const PosedSolid& solid, const Vector& v) {
  return solid.norm().support(solid.turned_to_own_frame(v));
}

/// An estimate of how far the optimum is from solid_point: along a path of w(mu) = w(0) + c mu^(1/k), as at a boundary
/// that is flat to k-th order, what is outstanding is k times mu w'(mu).
[[nodiscard]] inline Real reach(const PosedSolid& solid, const std::vector<Real>& outstanding, std::size_t first) {
  Vector x;
  for (std::size_t i = 0; i < 3; ++i) x[i] = outstanding[first + i] * solid.norm().semi_axes()[i];
  return 4 * std::max(solid.norm().outer().primal, solid.norm().inner().primal) * length(x);
}

}  // namespace verisq::oracle
