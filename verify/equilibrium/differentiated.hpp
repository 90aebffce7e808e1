/// Functions of several variables with all of their first derivatives, at 127 bits: forward-mode differentiation.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "verify/analysis/trigonometry.hpp"
#include "verify/numbers/interval.hpp"

namespace verisq::verify {

/// Over a box of the variables `value` contains all values, and `by[k]` all partial derivatives. Throws as intervals
/// do.
struct Differentiated {
  PreciseInterval value = 0;
  std::vector<PreciseInterval> by = {};  ///< one a variable; empty: a constant

  Differentiated() = default;
  Differentiated(double constant) : value(Real(constant)) {}  // NOLINT(google-explicit-constructor): a constant is one
  Differentiated(const PreciseInterval& constant)             // NOLINT(google-explicit-constructor): likewise
      : value(constant) {}
  Differentiated(const PreciseInterval& of, std::vector<PreciseInterval> derivatives)
      : value(of), by(std::move(derivatives)) {}

  /// The k-th of `count` variables.
  static Differentiated variable(const PreciseInterval& range, std::size_t k, std::size_t count) {
    Differentiated result(range, std::vector<PreciseInterval>(count, PreciseInterval(0)));
    result.by[k] = 1;
    return result;
  }

  friend Differentiated operator-(const Differentiated& a) { return chain(a, -a.value, -1); }
  friend Differentiated operator+(const Differentiated& a, const Differentiated& b) {
    return combined(a, 1, b, 1, a.value + b.value);
  }
  friend Differentiated operator-(const Differentiated& a, const Differentiated& b) {
    return combined(a, 1, b, -1, a.value - b.value);
  }
  friend Differentiated operator*(const Differentiated& a, const Differentiated& b) {
    return combined(a, b.value, b, a.value, a.value * b.value);
  }
  friend Differentiated operator/(const Differentiated& a, const Differentiated& b) {
    const PreciseInterval quotient = a.value / b.value;
    return combined(a, PreciseInterval(1) / b.value, b, -quotient / b.value, quotient);
  }
  Differentiated& operator+=(const Differentiated& b) { return *this = *this + b; }
  Differentiated& operator-=(const Differentiated& b) { return *this = *this - b; }

  friend Differentiated square(const Differentiated& a) {
    return chain(a, square(a.value), PreciseInterval(2) * a.value);
  }
  /// Infinite derivatives where the root comes down to 0.
  friend Differentiated sqrt(const Differentiated& a) {
    const PreciseInterval root = sqrt(a.value);
    return a.by.empty() ? Differentiated(root) : chain(a, root, PreciseInterval(1) / (PreciseInterval(2) * root));
  }
  friend Differentiated sin(const Differentiated& a) { return chain(a, sin(a.value), cos(a.value)); }
  friend Differentiated cos(const Differentiated& a) { return chain(a, cos(a.value), -sin(a.value)); }
  /// sgn(a) |a|^1.5, which has a continuous derivative everywhere.
  friend Differentiated power_of_three_halves(const Differentiated& a) {
    const PreciseInterval root = sqrt(abs(a.value));
    return chain(a, a.value * root, PreciseInterval(Real(1.5)) * root);
  }

 private:
  /// f(a), whose derivative by a is `slope`.
  static Differentiated chain(const Differentiated& a, const PreciseInterval& f, const PreciseInterval& slope) {
    Differentiated result(f, a.by);
    for (PreciseInterval& derivative : result.by) derivative = slope * derivative;
    return result;
  }

  /// f(a, b), whose derivatives by a and b are these.
  static Differentiated combined(const Differentiated& a, const PreciseInterval& by_a, const Differentiated& b,
                                 const PreciseInterval& by_b, const PreciseInterval& f) {
    if (b.by.empty()) return chain(a, f, by_a);
    if (a.by.empty()) return chain(b, f, by_b);
    Differentiated result(f, a.by);
    for (std::size_t k = 0; k < result.by.size(); ++k) result.by[k] = by_a * a.by[k] + by_b * b.by[k];
    return result;
  }
};

[[nodiscard]] inline PreciseInterval power_of_three_halves(const PreciseInterval& a) {
  return a * sqrt(abs(a));
}

/// Whether it is 0, and constant.
[[nodiscard]] inline bool is_zero(const PreciseInterval& a) {
  return a.lower() == Real(0) && a.upper() == Real(0);
}
[[nodiscard]] inline bool is_zero(const Differentiated& a) {
  return a.by.empty() && is_zero(a.value);
}

}  // namespace verisq::verify
