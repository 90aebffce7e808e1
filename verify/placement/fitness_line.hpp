/// A straight line above the fitness over a range of distances.
#pragma once

#include <algorithm>
#include <cmath>

#include "verisq/fitness.hpp"

namespace verisq::verify {

/// f(max(d, target)): no smaller than f, and falls or stays with d. But for a few 2^-53.
[[nodiscard]] inline double falling_fitness(const Fitness& fitness, double distance) {
  const double u = std::max(distance - fitness.target, 0.0) / fitness.scale;
  return 1.0 / (1.0 + u * u);
}

/// The largest of |f'|: at 1/√3 of the scale beyond the target, 3√3/8 a scale; rounded up.
[[nodiscard]] inline double steepest_fitness(const Fitness& fitness) {
  return 0.6495190528383291 / fitness.scale;
}

/// f(max(d, target)) <= value + slope (d - middle) for every d within `half` of the middle, but for a few 2^-53.
struct FitnessLine {
  double value;
  double slope;  ///< <= 0
};

// With u = (d - target)/scale, g(u) = 1/(1 + max(u, 0)²) is concave up to 1/√3 and convex beyond. Its concave envelope
// over [l, v] is g up to t, where the tangent runs through (v, g(v)), and that straight line from there: the tangency
// is (t - v)²(t² + 2vt - 1) = 0, of which t = 1/(v + √(1 + v²)) is the root below v where v > 1/√3; elsewhere t >= v
// and g is concave all along. Where l lies beyond t the chord of l and v is the envelope. Any line that supports the
// envelope at a point of it lies above g: here at the middle.
[[nodiscard]] inline FitnessLine line_above(const Fitness& fitness, double middle, double half) {
  const double m = (middle - fitness.target) / fitness.scale;
  const double h = half / fitness.scale;
  const double v = m + h;
  if (v <= 0.0) return {1.0, 0.0};
  const double t = 1.0 / (v + std::sqrt(1.0 + v * v));
  if (m <= t || v <= t) {
    const double at = std::max(m, 0.0);
    const double g = 1.0 / (1.0 + at * at);
    return {g, -2.0 * at * g * g / fitness.scale};
  }
  const double p = std::max(m - h, t);
  const double of_p = 1.0 / (1.0 + p * p);
  const double slope = -(v + p) * of_p / (1.0 + v * v);
  return {of_p + slope * (m - p), slope / fitness.scale};
}

}  // namespace verisq::verify
