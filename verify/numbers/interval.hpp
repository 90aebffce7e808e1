/// Interval arithmetic for proofs: Boost.Interval with the directed rounding of this library, at two precisions; sine,
/// cosine and arc tangent of thin intervals, by MPFR.
#pragma once

#include <boost/numeric/interval/arith.hpp>
#include <boost/numeric/interval/arith2.hpp>
#include <boost/numeric/interval/interval.hpp>
#include <boost/numeric/interval/policies.hpp>
#include <boost/numeric/interval/utility.hpp>
#include <stdexcept>

#include "verify/numbers/real.hpp"
#include "verify/numbers/rounding.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

// Interval arithmetic for proofs: Boost.Interval with the directed rounding of this library, at two precisions.

/// Boost.Interval's rounding policy. Boost's own policies switch the rounding mode, which compilers do not respect
/// (measured: docs/rounding.md §8); this one needs no mode and no state.
template <class T>
struct DirectedRounding {
  using unprotected_rounding = DirectedRounding;

  static T conv_down(const T& a) { return a; }
  static T conv_up(const T& a) { return a; }
  static T add_down(const T& a, const T& b) { return add(a, b, Direction::down); }
  static T add_up(const T& a, const T& b) { return add(a, b, Direction::up); }
  static T sub_down(const T& a, const T& b) { return subtract(a, b, Direction::down); }
  static T sub_up(const T& a, const T& b) { return subtract(a, b, Direction::up); }
  static T mul_down(const T& a, const T& b) { return multiply(a, b, Direction::down); }
  static T mul_up(const T& a, const T& b) { return multiply(a, b, Direction::up); }
  static T div_down(const T& a, const T& b) { return divide(a, b, Direction::down); }
  static T div_up(const T& a, const T& b) { return divide(a, b, Direction::up); }
  static T sqrt_down(const T& a) { return square_root(a, Direction::down); }
  static T sqrt_up(const T& a) { return square_root(a, Direction::up); }
};

/// Boost.Interval's checking policy: anything that is not an interval of real numbers is refused, never stored.
template <class T>
struct ThrowingChecking {
  static T pos_inf() { return infinity; }
  static T neg_inf() { return -infinity; }
  static bool is_nan(const T& a) {
    if (a != a) throw std::domain_error("interval: not a number");
    return false;
  }
  static T empty_lower() { throw std::domain_error("interval: empty"); }
  static T empty_upper() { return empty_lower(); }
  static bool is_empty(const T& lower, const T& upper) {
    if (!(lower <= upper)) throw std::domain_error("interval: empty or not a number");
    return false;
  }
};

/// The real numbers between two ends of type T; an infinite end is a missing bound. Every operation returns an interval
/// that contains all exact results. Throws std::domain_error for NaN, for lower > upper, and for an operation without a
/// result: division by [0, 0], the root of negative numbers alone, powers as `pow` says. Wraps Boost.Interval, whose
/// converting constructor template makes Eigen's products ambiguous.
template <class T>
class BasicInterval {
 public:
  BasicInterval() = default;
  BasicInterval(int value) : BasicInterval(T(value)) {}  // NOLINT(google-explicit-constructor): exact; Eigen needs it
  BasicInterval(const T& value) : BasicInterval(value, value) {}  // NOLINT(google-explicit-constructor): exact
  BasicInterval(const T& lower, const T& upper) : value_(lower, upper) {}

  [[nodiscard]] const T& lower() const { return value_.lower(); }
  [[nodiscard]] const T& upper() const { return value_.upper(); }

  BasicInterval& operator+=(const BasicInterval& b) { return *this = *this + b; }
  BasicInterval& operator-=(const BasicInterval& b) { return *this = *this - b; }
  BasicInterval& operator*=(const BasicInterval& b) { return *this = *this * b; }
  BasicInterval& operator/=(const BasicInterval& b) { return *this = *this / b; }

  friend BasicInterval operator-(const BasicInterval& a) { return BasicInterval(-a.value_); }
  friend BasicInterval operator+(const BasicInterval& a, const BasicInterval& b) {
    return BasicInterval(a.value_ + b.value_);
  }
  friend BasicInterval operator-(const BasicInterval& a, const BasicInterval& b) {
    return BasicInterval(a.value_ - b.value_);
  }
  friend BasicInterval operator*(const BasicInterval& a, const BasicInterval& b) {
    return BasicInterval(a.value_ * b.value_);
  }
  /// A divisor with 0 in its interior gives the whole line, one with 0 at an end a half-line where `a` has one sign.
  friend BasicInterval operator/(const BasicInterval& a, const BasicInterval& b) {
    // For [-x, 0] Boost forgets the sign and gives the whole line; [0, x] it divides tightly.
    if (a.upper() == T(0)) return -BasicInterval(-a.value_ / b.value_);
    return BasicInterval(a.value_ / b.value_);
  }

  friend BasicInterval abs(const BasicInterval& a) { return BasicInterval(boost::numeric::abs(a.value_)); }
  /// Tighter than a * a, which knows nothing of the dependency.
  friend BasicInterval square(const BasicInterval& a) { return BasicInterval(boost::numeric::square(a.value_)); }
  /// The root of the part of `a` that is not negative.
  friend BasicInterval sqrt(const BasicInterval& a) { return BasicInterval(boost::numeric::sqrt(a.value_)); }

  /// base^exponent. For a base that reaches below 0 only integer powers are defined: throws std::domain_error unless
  /// the exponent is one integer. 0^0 = 1. A negative power of 0 does not exist: throws std::domain_error if the
  /// interval has no other power.
  friend BasicInterval pow(const BasicInterval& base, const BasicInterval& exponent) {
    const T zero(0);
    if (base.lower() >= zero) return power_of_nonnegative(base, exponent);
    const T& n = exponent.lower();
    if (!(n == exponent.upper() && is_integer(n))) {
      throw std::domain_error("interval: a power of negative numbers whose exponent is not one integer");
    }
    const bool even = is_integer(divide(n, T(2), Direction::down));  // exact
    if (even) return power_of_nonnegative(abs(base), exponent);
    if (base.upper() <= zero) return -power_of_nonnegative(-base, exponent);
    return hull(-power_of_nonnegative({zero, -base.lower()}, exponent),
                power_of_nonnegative({zero, base.upper()}, exponent));
  }

  friend BasicInterval hull(const BasicInterval& a, const BasicInterval& b) {
    return {a.lower() < b.lower() ? a.lower() : b.lower(), a.upper() > b.upper() ? a.upper() : b.upper()};
  }

 private:
  using Policies = boost::numeric::interval_lib::policies<DirectedRounding<T>, ThrowingChecking<T>>;
  using Value = boost::numeric::interval<T, Policies>;

  /// Checked, because Boost does not look at the results of its own operations.
  explicit BasicInterval(const Value& value) : BasicInterval(value.lower(), value.upper()) {}

  /// [infinity, infinity] and [-infinity, -infinity] hold no number.
  static BasicInterval with_numbers(const BasicInterval& a) {
    const T beyond(infinity);
    if (a.lower() == beyond || a.upper() == -beyond) throw std::domain_error("interval: no value but at infinity");
    return a;
  }

  /// Monotone in each operand on its own, so that the corners bound it.
  static BasicInterval power_of_nonnegative(const BasicInterval& base, const BasicInterval& exponent) {
    BasicInterval result = corner_power(base.lower(), exponent.lower());
    result = hull(result, corner_power(base.lower(), exponent.upper()));
    result = hull(result, corner_power(base.upper(), exponent.lower()));
    return with_numbers(hull(result, corner_power(base.upper(), exponent.upper())));
  }

  static BasicInterval corner_power(const T& base, const T& exponent) {
    return {power(base, exponent, Direction::down), power(base, exponent, Direction::up)};
  }

  Value value_;
};

/// Binary64 ends: fast enough for search.
using Interval = BasicInterval<double>;
/// 127-bit ends and an exponent range that binary64 input cannot leave: for the last word.
using PreciseInterval = BasicInterval<Real>;

// Sine, cosine and arc tangent of thin intervals, by MPFR.

/// For thin intervals: the result is the value at the angle's lower end, widened by the width of the angle.
[[nodiscard]] PreciseInterval sine_of(const PreciseInterval& angle);
[[nodiscard]] PreciseInterval cosine_of(const PreciseInterval& angle);

[[nodiscard]] PreciseInterval arctangent_of(const PreciseInterval& a);

/// sin(a)/a and atan(a)/a, 1 at a = 0: without cancellation.
[[nodiscard]] PreciseInterval quotient_of_sine(const PreciseInterval& a);
[[nodiscard]] PreciseInterval quotient_of_arctangent(const PreciseInterval& a);

/// Exact at multiples of 90. Precondition: finite.
[[nodiscard]] PreciseInterval sine_of_degrees(double degrees);
[[nodiscard]] PreciseInterval cosine_of_degrees(double degrees);

[[nodiscard]] PreciseInterval half_turn();  ///< pi

}  // namespace verisq::verify
