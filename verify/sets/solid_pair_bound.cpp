/// Projections propose a direction; linear programming duality proves what it separates.
#include "verify/sets/solid_pair_bound.hpp"

#include <algorithm>
#include <cmath>

#include "verify/proposals/triangle.hpp"

namespace verisq::verify {

namespace {

/// Each doubles the accuracy of a direction that neighbours share already.
constexpr int kMostProjections = 8;

double absolute_dot(const Point& a, const Point& b) {
  return std::fabs(a[0] * b[0]) + std::fabs(a[1] * b[1]) + std::fabs(a[2] * b[2]);
}

double absolute_sum(const Point& a) {
  return std::fabs(a[0]) + std::fabs(a[1]) + std::fabs(a[2]);
}

}  // namespace

Point unit(const Point& n) {
  const double length = std::hypot(n[0], n[1], n[2]);
  if (!(length > 0.0) || !std::isfinite(length)) return {};
  return {n[0] / length, n[1] / length, n[2] / length};
}

template <Separable X, Separable Y>
double lower_by_direction(const X& x, const Y& y, const BoundedMotion& motion, const Point& n) {
  // n·(R y + t - x) = (R^T n)·y + n·t - n·x, with m for R^T n: what m is off by meets |y|_1 at most.
  const Point m = motion.direction_in_b(n);
  const double support_x = x.support(n);
  const double support_y = y.support({-m[0], -m[1], -m[2]});
  const Point& a = x.cube().centre;
  const Point& b = y.cube().centre;
  const double slab = dot(n, motion.translation()) + dot(m, b) - dot(n, a) - support_x - support_y;
  // Fewer than 16 roundings between an input and the sum: below 32 u times the absolute terms, computed so well too.
  const double terms = absolute_dot(n, motion.translation()) + absolute_dot(m, b) + absolute_dot(n, a) +
                       std::fabs(support_x) + std::fabs(support_y);
  const double turned =
      2.0 * BoundedMotion::rotation_error * absolute_sum(n) * (absolute_sum(b) + 3.0 * y.cube().half_width);
  const double proven = slab - 0x1p-47 * terms - turned - 0x1p-1000;
  if (!(proven > 0.0)) return 0.0;
  const double length = std::sqrt(dot(n, n)) * (1.0 + 0x1p-50);  // n is about as long as 1: nothing underflows
  return proven / length * (1.0 - 0x1p-50);
}

template <Separable X, Separable Y>
Approach approach(const X& x, const Y& y, const BoundedMotion& motion, const Point& guess, double enough) {
  Approach found{lower_by_direction(x, y, motion, guess), 0.0, x.cube().centre, y.cube().centre};
  const double little = 0x1p-10 * std::min(x.cube().half_width, y.cube().half_width);
  for (int step = 0; step < kMostProjections && found.lower < enough; ++step) {
    found.on_b = y.nearest(motion.to_b(found.on_a));
    const Point on_b = motion.to_a(found.on_b);
    found.on_a = x.nearest(on_b);
    const Point between{on_b[0] - found.on_a[0], on_b[1] - found.on_a[1], on_b[2] - found.on_a[2]};
    found.between = std::hypot(between[0], between[1], between[2]);
    found.lower = std::max(found.lower, lower_by_direction(x, y, motion, unit(between)));
    if (found.between - found.lower <= little) break;
  }
  return found;
}

template double lower_by_direction(const CutCube&, const CutCube&, const BoundedMotion&, const Point&);
template Approach approach(const CutCube&, const CutCube&, const BoundedMotion&, const Point&, double);
template Approach approach(const WholePrimitive&, const CutCube&, const BoundedMotion&, const Point&, double);
template Approach approach(const CutCube&, const WholePrimitive&, const BoundedMotion&, const Point&, double);

}  // namespace verisq::verify
