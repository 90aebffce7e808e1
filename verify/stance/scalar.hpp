/// The scalars of the multibody code, double and Interval, under one set of names; dual.hpp adds derivatives.
#pragma once

#include <cmath>

#include "verify/analysis/interval_matrix.hpp"
#include "verify/analysis/trigonometry.hpp"

namespace verisq::stance {

using verify::Interval;

// Templates call these without a namespace: for Interval, lookup by argument finds those of verify/.
using std::abs;
using std::cos;
using std::exp;
using std::log;
using std::pow;
using std::sin;
using std::sqrt;

[[nodiscard]] inline double square(double a) {
  return a * a;
}

[[nodiscard]] inline bool is_zero(double a) {
  return a == 0.0;
}
[[nodiscard]] inline bool is_zero(const Interval& a) {
  return a.lower() == 0.0 && a.upper() == 0.0;
}

/// Whether all of `a` lies below all of `b`.
[[nodiscard]] inline bool certainly_less(double a, double b) {
  return a < b;
}
[[nodiscard]] inline bool certainly_less(const Interval& a, const Interval& b) {
  return a.upper() < b.lower();
}

/// What stands for both values where it is open which of two branches holds: the hull. One double cannot hold a hull;
/// it gets the mean, which is what central differences tend to at a kink.
[[nodiscard]] inline double either(double a, double b) {
  return a == b ? a : 0.5 * (a + b);
}
[[nodiscard]] inline Interval either(const Interval& a, const Interval& b) {
  return hull(a, b);
}

/// What lies in both. Throws std::domain_error where nothing does: they did not both contain the same number.
[[nodiscard]] inline Interval intersection(const Interval& a, const Interval& b) {
  return {std::fmax(a.lower(), b.lower()), std::fmin(a.upper(), b.upper())};
}

/// The part of `a` at or below, or at or above, a threshold. Precondition: there is such a part.
[[nodiscard]] inline double part_below(double a, double) {
  return a;
}
[[nodiscard]] inline double part_above(double a, double) {
  return a;
}
[[nodiscard]] inline Interval part_below(const Interval& a, double threshold) {
  return {a.lower(), a.upper() < threshold ? a.upper() : threshold};
}
[[nodiscard]] inline Interval part_above(const Interval& a, double threshold) {
  return {a.lower() > threshold ? a.lower() : threshold, a.upper()};
}

}  // namespace verisq::stance
