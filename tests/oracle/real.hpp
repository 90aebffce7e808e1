/// The number type of the test oracle: MPFR at 200 bits, with operators.
#pragma once

#include <array>
#include <boost/multiprecision/mpfr.hpp>
#include <limits>
#include <string>

namespace verisq::oracle {

/// 60 decimal digits are 201 bits. On the stack and of fixed precision, hence without shared state between threads.
using Real =
    boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<60, boost::multiprecision::allocate_stack>,
                                  boost::multiprecision::et_off>;

/// Boost 1.74 makes each value of numeric_limits at its first call, without a lock: a second thread could read 0 for
/// infinity (2000 runs of two threads: 80 did). The first calls are made here, before any thread starts.
inline const std::array limits_made_before_threads{std::numeric_limits<Real>::infinity(),
                                                   std::numeric_limits<Real>::epsilon()};

template <class Number>
using Triple = std::array<Number, 3>;
using Vector = Triple<Real>;

template <class Number>
[[nodiscard]] Number dot(const Triple<Number>& a, const Triple<Number>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <class Number>
[[nodiscard]] Number length(const Triple<Number>& a) {
  using std::sqrt;
  return sqrt(dot(a, a));
}

template <class Number>
[[nodiscard]] Triple<Number> difference(const Triple<Number>& a, const Triple<Number>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

template <class Number>
[[nodiscard]] Triple<Number> scaled(const Triple<Number>& a, const Number& factor) {
  return {a[0] * factor, a[1] * factor, a[2] * factor};
}

[[nodiscard]] inline Vector widened(const Triple<double>& a) {
  return {Real(a[0]), Real(a[1]), Real(a[2])};
}

/// 25 significant digits.
[[nodiscard]] inline std::string text(const Real& a) {
  std::array<char, 64> digits{};
  mpfr_snprintf(digits.data(), digits.size(), "%.25Rg", a.backend().data());
  return digits.data();
}

[[nodiscard]] inline Triple<double> rounded(const Vector& a) {
  return {a[0].convert_to<double>(), a[1].convert_to<double>(), a[2].convert_to<double>()};
}

}  // namespace verisq::oracle
