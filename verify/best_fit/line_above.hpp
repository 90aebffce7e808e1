/// A straight line above the fitness over a range of distances, proven by the sign of a polynomial.
#pragma once

#include <algorithm>
#include <cmath>

#include "verify/numbers/interval.hpp"
#include "verisq/fitness.hpp"

namespace verisq::verify {

/// f(max(d, target)) >= f(d) for all distances from `distance` on: it never rises. Rounded up.
[[nodiscard]] inline double falling_fitness_up(const Fitness& fitness, double distance) {
  if (!(distance > fitness.target)) return 1.0;
  if (distance == infinity) return 0.0;
  const Interval u = (Interval(distance) - Interval(fitness.target)) / Interval(fitness.scale);
  return std::min((Interval(1) / (Interval(1) + square(u))).upper(), 1.0);
}

/// The largest of |f'| beyond the target: 3√3/8 a scale, where (d - target)/scale is 1/√3.
[[nodiscard]] inline Interval steepest_fitness(const Fitness& fitness) {
  return Interval(3) * sqrt(Interval(3)) / (Interval(8) * Interval(fitness.scale));
}

/// f(max(d, target)) <= value + slope (d - middle) for every d of the range; slope <= 0.
struct LineAbove {
  Interval value;
  Interval slope;
};

// With u = (d - target)/scale, f(max(d, target)) is g(u) = 1/(1 + max(u, 0)²). Let 0 <= p <= v.
// The tangent T of 1/(1 + u²) at p is no smaller than g for all u <= v where p² + 2pv <= 1: for 0 <= u,
//     T(u) - g(u) = (u - p)² (1 - p² - 2pu) / ((1 + p²)² (1 + u²)),
// and for u < 0 it is no smaller than at 0, which is (1 + 3p²)/(1 + p²)² >= 1 because p² <= 1.
// The chord C from p to v is no smaller than g between them where p² + 2pv >= 1:
//     C(u) - g(u) = (u - p)(v - u)(uv + p(u + v) - 1) / ((1 + p²)(1 + u²)(1 + v²)).
// The best line touches the concave envelope of g at the middle, or is its straight part, from 1/(v + √(1 + v²)) to v.
[[nodiscard]] inline LineAbove line_above(const Fitness& fitness, double middle, double half) {
  const Interval target(fitness.target);
  const Interval scale(fitness.scale);
  const Interval u = (Interval(middle) - target) / scale;
  const double v = ((Interval(middle) + Interval(half) - target) / scale).upper();
  if (!(v > 0.0)) return {Interval(1), Interval(0)};
  const double lowest = ((Interval(middle) - Interval(half) - target) / scale).lower();
  const double tangency = 1.0 / (v + std::sqrt(1.0 + v * v));
  const auto unit = [](const Interval& x) { return Interval(1) / (Interval(1) + square(x)); };
  const auto line = [&](double p, const Interval& slope) {
    return LineAbove{unit(Interval(p)) + slope * (u - Interval(p)), slope / scale};
  };
  const auto sign = [v](double p) { return square(Interval(p)) + Interval(2) * Interval(p) * Interval(v); };
  if (lowest < tangency * (1.0 + 0x1p-30)) {
    const double p = std::clamp(u.lower(), 0.0, tangency * (1.0 - 0x1p-40));
    const Interval at = unit(Interval(p));
    if (p <= v && sign(p).upper() <= 1.0) return line(p, -(Interval(2) * Interval(p) * square(at)));
  } else if (sign(lowest).lower() >= 1.0) {
    const Interval sum = Interval(v) + Interval(lowest);
    return line(lowest, -(sum * unit(Interval(lowest)) * unit(Interval(v))));
  }
  return {Interval(falling_fitness_up(fitness, (Interval(middle) - Interval(half)).lower())), Interval(0)};
}

}  // namespace verisq::verify
