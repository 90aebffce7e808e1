/// The numbers of a stance model: intervals, piecewise functions, derivatives.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>

#include "verify/numbers/functions.hpp"
#include "verify/search/krawczyk.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::stance {

// The scalars of the multibody code, double and Interval, under one set of names; dual.hpp adds derivatives.

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

// Piecewise functions, |x|, sgn, max, min, clamp and any other of two branches, with the hull of the branches where an
// interval contains a switch (the paper's pwFunc, §3; docs/stance.md §4).

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

// Forward-mode differentiation: a value and its partial derivatives by N variables, sound over intervals at kinks too.

/// Of scalars that know the hull of two branches.
template <class T>
inline constexpr bool has_kinks = std::same_as<T, double> || std::same_as<T, Interval>;
template <class T>
concept PlainScalar = has_kinks<T>;

/// Over intervals, `value` contains all values over a box of the variables, and `partial[k]` contains all partial
/// derivatives over that box: at a kink the hull of the one-sided ones, so that mean-value forms hold. Operations throw
/// as those of T do. Over doubles, a kink gives the mean of the one-sided derivatives. T is double or Interval; for
/// second derivatives it may be a Dual, which then has no functions with kinks: those have no second derivative there.
template <class T, std::size_t N = 1>
struct Dual {
  T value = T(0);
  std::array<T, N> partial = zeros();

  Dual() = default;
  Dual(const T& constant) : value(constant) {}  // NOLINT(google-explicit-constructor): a constant is a function
  Dual(const T& f, const std::array<T, N>& derivatives) : value(f), partial(derivatives) {}
  Dual(double constant)  // NOLINT(google-explicit-constructor): likewise
      requires(!std::same_as<T, double>)
      : value(constant) {}
  Dual(int constant) : value(constant) {}  // NOLINT(google-explicit-constructor): Eigen needs it

  /// The k-th variable.
  static Dual variable(const T& at, std::size_t k = 0) {
    Dual result(at);
    result.partial[k] = T(1);
    return result;
  }

  Dual& operator+=(const Dual& b) { return *this = *this + b; }
  Dual& operator-=(const Dual& b) { return *this = *this - b; }
  Dual& operator*=(const Dual& b) { return *this = *this * b; }
  Dual& operator/=(const Dual& b) { return *this = *this / b; }

  friend Dual operator-(const Dual& a) { return chain(a, -a.value, T(-1)); }
  friend Dual operator+(const Dual& a, const Dual& b) {
    return combine(a, b, a.value + b.value, [](const T& da, const T& db) { return T(da + db); });
  }
  friend Dual operator-(const Dual& a, const Dual& b) {
    return combine(a, b, a.value - b.value, [](const T& da, const T& db) { return T(da - db); });
  }
  friend Dual operator*(const Dual& a, const Dual& b) {
    return combine(a, b, a.value * b.value, [&](const T& da, const T& db) { return T(da * b.value + a.value * db); });
  }
  friend Dual operator/(const Dual& a, const Dual& b) {
    const T quotient = a.value / b.value;
    return combine(a, b, quotient, [&](const T& da, const T& db) { return T((da - quotient * db) / b.value); });
  }

  friend Dual square(const Dual& a) { return chain(a, square(a.value), T(2) * a.value); }
  /// Infinite derivatives where the root comes down to 0; at 0 alone, std::domain_error over intervals.
  friend Dual sqrt(const Dual& a) {
    const T root = sqrt(a.value);
    return chain(a, root, T(1) / (T(2) * root));
  }
  friend Dual sin(const Dual& a) { return chain(a, sin(a.value), cos(a.value)); }
  friend Dual cos(const Dual& a) { return chain(a, cos(a.value), -sin(a.value)); }
  friend Dual exp(const Dual& a) {
    const T power = exp(a.value);
    return chain(a, power, power);
  }
  friend Dual log(const Dual& a) { return chain(a, log(a.value), T(1) / a.value); }
  /// As pow() of T; base 0 and below want a constant exponent, because their logarithm is missing.
  friend Dual pow(const Dual& base, const Dual& exponent) {
    const T power = pow(base.value, exponent.value);
    const Dual by_base = chain(base, power, exponent.value * pow(base.value, exponent.value - T(1)));
    if (exponent.is_constant()) return by_base;
    return Dual(T(0), by_base.partial) + chain(exponent, power, power * log(base.value));
  }
  friend Dual pow(const Dual& base, double exponent) { return pow(base, Dual(T(exponent))); }

  /// The derivative of |x| is sgn(x), the hull [-1, 1] wherever x contains 0.
  friend Dual abs(const Dual& a) requires PlainScalar<T> { return chain(a, abs(a.value), sgn(a.value)); }
  friend Dual sgn(const Dual& a) requires PlainScalar<T> { return chain(a, sgn(a.value), sgn_slope(a.value)); }
  friend Dual max(const Dual& a, const Dual& b) requires PlainScalar<T> {
    if (certainly_less(a, b)) return b;
    if (certainly_less(b, a)) return a;
    return {max(a.value, b.value), either(a, b).partial};
  }
  friend Dual min(const Dual& a, const Dual& b) requires PlainScalar<T> { return -max(-a, -b); }

  friend bool is_zero(const Dual& a) { return is_zero(a.value) && a.is_constant(); }
  friend bool certainly_less(const Dual& a, const Dual& b) { return certainly_less(a.value, b.value); }
  friend Dual either(const Dual& a, const Dual& b) requires PlainScalar<T> {
    return combine(a, b, either(a.value, b.value), [](const T& da, const T& db) { return T(either(da, db)); });
  }
  friend Dual part_below(const Dual& a, double threshold) { return {part_below(a.value, threshold), a.partial}; }
  friend Dual part_above(const Dual& a, double threshold) { return {part_above(a.value, threshold), a.partial}; }

 private:
  static std::array<T, N> zeros() {
    std::array<T, N> result;
    result.fill(T(0));
    return result;
  }

  [[nodiscard]] bool is_constant() const {
    return std::all_of(partial.begin(), partial.end(), [](const T& derivative) { return is_zero(derivative); });
  }

  /// f(a) by the chain rule.
  static Dual chain(const Dual& a, const T& f, const T& slope) {
    Dual result(f);
    for (std::size_t k = 0; k < N; ++k) result.partial[k] = slope * a.partial[k];
    return result;
  }

  /// f(a, b), whose derivatives `rule` makes of those of a and b.
  template <class Rule>
  static Dual combine(const Dual& a, const Dual& b, const T& f, const Rule& rule) {
    Dual result(f);
    for (std::size_t k = 0; k < N; ++k) result.partial[k] = rule(a.partial[k], b.partial[k]);
    return result;
  }
};

}  // namespace verisq::stance

template <class T, std::size_t N>
struct Eigen::NumTraits<verisq::stance::Dual<T, N>> : Eigen::GenericNumTraits<verisq::stance::Dual<T, N>> {
  using Real = verisq::stance::Dual<T, N>;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = Real;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 1,
    ReadCost = static_cast<int>(N) + 1,
    AddCost = 8 * (static_cast<int>(N) + 1),
    MulCost = 16 * (static_cast<int>(N) + 1)
  };
};
