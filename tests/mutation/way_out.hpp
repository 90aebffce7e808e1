/// How far it is out of a superquadric from a point inside, to long double: what the judges of kernels measure by.
#pragma once

#include <array>
#include <cmath>
#include <utility>
#include <verisq/model.hpp>

#include "tests/oracle/mixed_norm.hpp"
#include "tests/oracle/random_cases.hpp"

namespace verisq::mutation {

using Extended = long double;
using Vector = std::array<Extended, 3>;
using Norm = oracle::MixedNorm<Extended>;

[[nodiscard]] inline Vector extended(const Point& x) {
  return {x[0], x[1], x[2]};
}

[[nodiscard]] inline Extended dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

[[nodiscard]] inline Extended length(const Vector& a) {
  return std::sqrt(dot(a, a));
}

[[nodiscard]] inline Vector scaled(const Vector& x, Extended factor) {
  return {factor * x[0], factor * x[1], factor * x[2]};
}

[[nodiscard]] inline Vector along(const Vector& x, Extended factor, const Vector& y) {
  return {x[0] + factor * y[0], x[1] + factor * y[1], x[2] + factor * y[2]};
}

/// Of the octant of positive coordinates.
[[nodiscard]] inline Point point(oracle::RandomCases& random) {
  return {random.log_uniform(0.01, 1.0), random.log_uniform(0.01, 1.0), random.log_uniform(0.01, 1.0)};
}

[[nodiscard]] inline Point with_gauge(Extended gauge, oracle::RandomCases& random, const Norm& norm) {
  const Vector x = extended(point(random));
  const Vector y = scaled(x, gauge / norm.gauge(x));
  return {static_cast<double>(y[0]), static_cast<double>(y[1]), static_cast<double>(y[2])};
}

inline constexpr Extended beyond_solids = 4.0L;  // a length

/// How far the solid's boundary is from q in the direction of w, or 2^-40 of it more. The gauge is convex along the
/// way, so that lines through two points outside meet 1 outside, closer and closer.
[[nodiscard]] inline Extended way_out(const Vector& q, const Vector& w, const Norm& norm) {
  const Vector u = scaled(w, 1.0L / length(w));
  const auto excess = [&](Extended s) { return norm.gauge(along(q, s, u)) - 1.0L; };
  Extended far = beyond_solids;
  Extended near = 0.9L * beyond_solids;
  Extended far_excess = excess(far);
  while (far - near > 0x1p-40L * near) {
    const Extended near_excess = excess(near);
    const Extended next = near - near_excess * (far - near) / (far_excess - near_excess);
    far = std::exchange(near, next);
    far_excess = near_excess;
  }
  return far;
}

}  // namespace verisq::mutation
