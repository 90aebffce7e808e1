/// Elementary functions of intervals by MPFR, fast ones of binary64 numbers with proven errors, and functions of
/// vectors that maps and octrees are proven without.
#pragma once

#include <stdexcept>

#include "verify/numbers/interval.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/numbers/vector.hpp"

namespace verisq::verify {

// Elementary functions of intervals.

// Exponentials and logarithms of numbers, rounded to one side, and of intervals.

template <mpfr_prec_t Bits>
[[nodiscard]] MpfrNumber<Bits> exponential(const MpfrNumber<Bits>& a, Direction direction) {
  release_mpfr_cache_at_thread_exit();
  return rounded_result<Bits>(mpfr_exp, direction, a.get());
}

template <mpfr_prec_t Bits>
[[nodiscard]] MpfrNumber<Bits> logarithm(const MpfrNumber<Bits>& a, Direction direction) {
  release_mpfr_cache_at_thread_exit();
  return rounded_result<Bits>(mpfr_log, direction, a.get());
}

/// log(1 + a)
template <mpfr_prec_t Bits>
[[nodiscard]] MpfrNumber<Bits> logarithm_1p(const MpfrNumber<Bits>& a, Direction direction) {
  release_mpfr_cache_at_thread_exit();
  return rounded_result<Bits>(mpfr_log1p, direction, a.get());
}

// The same contract as the powers of verify/numbers/real.hpp.

[[nodiscard]] double exponential(double a, Direction direction);
[[nodiscard]] double logarithm(double a, Direction direction);
[[nodiscard]] double logarithm_1p(double a, Direction direction);

/// Throws std::domain_error where [infinity, infinity] or [-infinity, -infinity] hold no number.
template <class T>
[[nodiscard]] BasicInterval<T> logarithms_between(const T& lower, const T& upper) {
  const T beyond(infinity);
  if (lower == beyond || upper == -beyond) throw std::domain_error("interval: no value but at infinity");
  return {lower, upper};
}

template <class T>
[[nodiscard]] BasicInterval<T> exp(const BasicInterval<T>& a) {
  return {exponential(a.lower(), Direction::down), exponential(a.upper(), Direction::up)};
}

/// Throws std::domain_error for negative numbers, and for 0 alone.
template <class T>
[[nodiscard]] BasicInterval<T> log(const BasicInterval<T>& a) {
  return logarithms_between<T>(logarithm(a.lower(), Direction::down), logarithm(a.upper(), Direction::up));
}

/// log(1 + a)
template <class T>
[[nodiscard]] BasicInterval<T> log1p(const BasicInterval<T>& a) {
  return logarithms_between<T>(logarithm_1p(a.lower(), Direction::down), logarithm_1p(a.upper(), Direction::up));
}

// Enclosures of trigonometric functions by MPFR: sin, cos, atan and the even quotients that stay accurate at 0.

// Templates over the type of the ends: double or Real. Nothing here throws.

/// The extrema within the interval are counted, not assumed. Beyond 2^60, or for a wide interval, the result is [-1,
/// 1].
template <class T>
[[nodiscard]] BasicInterval<T> sin(const BasicInterval<T>& angle);
template <class T>
[[nodiscard]] BasicInterval<T> cos(const BasicInterval<T>& angle);

template <class T>
[[nodiscard]] BasicInterval<T> atan(const BasicInterval<T>& a);

/// sin(a)/a, 1 at a = 0: without cancellation or division by 0.
template <class T>
[[nodiscard]] BasicInterval<T> sine_quotient(const BasicInterval<T>& a);

/// atan(a)/a, 1 at a = 0: even, between 0 and 1, falling with |a|.
template <class T>
[[nodiscard]] BasicInterval<T> arctangent_quotient(const BasicInterval<T>& a);

/// The angles in (-pi, pi] of all points (x, y) of two intervals, from the positive x axis. The result is [-pi, pi] if
/// the points meet the cut, the negative x axis, from below; it lies within [0, pi] for y >= 0. The origin has no
/// angle; if it is the only point, the result is [0, pi].
template <class T>
[[nodiscard]] BasicInterval<T> polar_angle(const BasicInterval<T>& x, const BasicInterval<T>& y);

template <class T>
[[nodiscard]] BasicInterval<T> pi();

/// The sine and the cosine of an exact angle in degrees: exact at multiples of 90. Precondition: finite.
template <class T>
[[nodiscard]] BasicInterval<T> sin_of_degrees(double degrees);
template <class T>
[[nodiscard]] BasicInterval<T> cos_of_degrees(double degrees);

// Elementary functions bounded in plain binary64 arithmetic with a-priori errors: for search, where MPFR would take
// most of the time.

/// A bound of base^exponent for 0 <= base <= 2 and exponent >= 0, on the side `direction`. Off by at most
/// (12 |log(base^exponent)| + 8) 2^-52 of the result where that is above 1e-300, and never beyond 1.
[[nodiscard]] double fast_power(double base, double exponent, Direction direction);

/// A bound of atan(t)/t for 0 <= t <= 1, off by at most 2^-48 of the result and never above 1.
[[nodiscard]] double fast_arctangent_quotient(double t, Direction direction);

// The vector product of vectors of intervals.

template <class T>
[[nodiscard]] Vector3<T> cross(const Vector3<T>& a, const Vector3<T>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// Precise enclosures with binary64 ends, rounded outward: for searches, which ask more often.

[[nodiscard]] inline Interval in_binary64(const PreciseInterval& a) {
  return {a.lower().to_double(Direction::down), a.upper().to_double(Direction::up)};
}

[[nodiscard]] inline Vector3<double> in_binary64(const PreciseVector& v) {
  return {in_binary64(v[0]), in_binary64(v[1]), in_binary64(v[2])};
}

[[nodiscard]] inline Matrix3<double> in_binary64(const PreciseMatrix& m) {
  return {in_binary64(m.row(0)), in_binary64(m.row(1)), in_binary64(m.row(2))};
}

// Points as vectors of intervals of no width.

[[nodiscard]] inline Vector3<double> exact_vector(const Point& x) {
  return {Interval(x[0]), Interval(x[1]), Interval(x[2])};
}

}  // namespace verisq::verify
