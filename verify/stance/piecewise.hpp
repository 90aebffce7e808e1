/// Piecewise functions, |x|, sgn, max, min, clamp and any other of two branches, with the hull of the branches where an
/// interval contains a switch (the paper's pwFunc, §3; docs/stance.md §4).
#pragma once

#include "verify/stance/scalar.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::stance {

/// -1 or 1; at a double 0, 0. Over an interval that contains 0, even as its end: [-1, 1], as in a contact's area.
[[nodiscard]] inline double sgn(double x) {
  return x > 0.0 ? 1.0 : (x < 0.0 ? -1.0 : 0.0);
}
[[nodiscard]] inline Interval sgn(const Interval& x) {
  if (x.lower() > 0.0) return 1;
  if (x.upper() < 0.0) return -1;
  return {-1.0, 1.0};
}

/// The one-sided derivatives of sgn: 0, and at its jump all slopes from 0 to infinity. Times an inner derivative, this
/// contains every difference quotient. A double knows of no jump: 0 everywhere.
[[nodiscard]] inline double sgn_slope(double) {
  return 0.0;
}
[[nodiscard]] inline Interval sgn_slope(const Interval& x) {
  if (x.lower() > 0.0 || x.upper() < 0.0) return 0;
  return {0.0, infinity};
}

[[nodiscard]] inline double max(double a, double b) {
  return a < b ? b : a;
}
[[nodiscard]] inline double min(double a, double b) {
  return b < a ? b : a;
}
/// Monotone in each operand: the ends bound it.
[[nodiscard]] inline Interval max(const Interval& a, const Interval& b) {
  return {max(a.lower(), b.lower()), max(a.upper(), b.upper())};
}
[[nodiscard]] inline Interval min(const Interval& a, const Interval& b) {
  return {min(a.lower(), b.lower()), min(a.upper(), b.upper())};
}

/// The nearest number to x between the two. Precondition: lowest <= highest.
template <class T>
[[nodiscard]] T clamp(const T& x, const T& lowest, const T& highest) {
  return min(max(x, lowest), highest);
}

/// below(x) for x < threshold and above(x) for x > threshold: each is asked for its own part of x alone, and both where
/// x touches the threshold. Derivatives contain all difference quotients only where the branches meet at the threshold.
template <class T, class Below, class Above>
[[nodiscard]] T piecewise(const T& x, double threshold, const Below& below, const Above& above) {
  if (certainly_less(x, T(threshold))) return below(x);
  if (certainly_less(T(threshold), x)) return above(x);
  return either(T(below(part_below(x, threshold))), T(above(part_above(x, threshold))));
}

}  // namespace verisq::stance
