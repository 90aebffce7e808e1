/// Exponentials and logarithms of numbers, rounded to one side, and of intervals.
#pragma once

#include <stdexcept>

#include "verify/numbers/interval.hpp"

namespace verisq::verify {

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

// As the powers of verify/numbers/real.hpp.

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

}  // namespace verisq::verify
