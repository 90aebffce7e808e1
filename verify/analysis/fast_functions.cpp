/// Logarithm and arctangent by their series about 0, exponential by Taylor's; every rounding error is counted.
#include "verify/analysis/fast_functions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "verify/numbers/real.hpp"

namespace verisq::verify {

namespace {

// Below, u = 2^-53 bounds the relative error of each operation: nothing here overflows, and what underflows (a squared
// small number, a tiny logarithm) is added to 1.

constexpr double kRoundoff = 0x1p-53;

/// 1/21, 1/19 ... 1/3
constexpr std::array<double, 10> kOddReciprocals = [] {
  std::array<double, 10> result{};
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = 1.0 / static_cast<double>(21 - 2 * i);
  return result;
}();

/// 1/17, -1/15 ... -1/3: of t^16, t^14 ... t^2 in atan(t)/t
constexpr std::array<double, 8> kAlternatingReciprocals = [] {
  std::array<double, 8> result{};
  for (std::size_t i = 0; i < result.size(); ++i)
    result[i] = (i % 2 == 0 ? 1.0 : -1.0) / (17.0 - 2.0 * static_cast<double>(i));
  return result;
}();

/// 1/13!, 1/12! ... 1/0!, of exact factorials
constexpr std::array<double, 14> kFactorialReciprocals = [] {
  std::array<double, 14> result{};
  double factorial = 1.0;
  for (std::size_t i = 0; i < result.size(); ++i) {
    result[result.size() - 1 - i] = 1.0 / factorial;
    factorial *= static_cast<double>(i + 1);
  }
  return result;
}();

/// By Horner's rule, the highest coefficient first.
template <std::size_t Size>
double polynomial(const std::array<double, Size>& coefficients, double x) {
  double result = 0.0;
  for (const double c : coefficients) result = c + x * result;
  return result;
}

/// Relative error at most 10 u. Precondition: x normal, 2^-1000 <= x <= 2, x != 1.
double natural_logarithm(double x) {
  int exponent = 0;
  double f = std::frexp(x, &exponent);
  if (f < 0.5 * std::numbers::sqrt2) {
    f *= 2.0;
    --exponent;
  }
  // log f = 2 artanh s, |s| <= 0.1716. f - 1 is exact (Sterbenz); the sum and the quotient make 2 u of s, 5 u of s^2.
  const double s = (f - 1.0) / (f + 1.0);
  const double q = s * s;
  // 1 + q/3 + ... + q^10/21; what follows is below q^11/23/(1 - q) < 1e-18. Positive terms: with q <= 0.0295 each stage
  // passes on less than 0.03 (5 u + u + the error of the stage before), which leaves 1.5 u for the last one.
  const double series = 1.0 + q * polynomial(kOddReciprocals, q);
  // 2 u + 1.5 u + u (the factor 2 is exact) < 5 u.
  const double log_f = 2.0 * s * series;
  // The constant and the product make 2 u of e log 2, at most 4 u of the sum because |log f| is at most half of that
  // for e != 0; log f makes 5 u more and the sum u: 10 u. For e = 0 it is 5 u.
  return exponent == 0 ? log_f : exponent * std::numbers::ln2 + log_f;
}

/// Relative error at most 4 u. Precondition: |t| <= 700, so that the result is a normal number.
double natural_exponential(double t) {
  constexpr double ln2_tail = 0x1.abc9e3b39803fp-56;  // log 2 - ln2, to 2^-108: far below u with |n| <= 1010
  const double n = std::nearbyint(t * std::numbers::log2e);
  // |r| <= 0.35; each of the two roundings makes 0.35 u, together below u absolutely, hence u of the result.
  const double r = std::fma(-n, ln2_tail, std::fma(-n, std::numbers::ln2, t));
  // Taylor to r^13; what follows is below 0.35^14 e^0.35 / 14! < 1e-17, 0.1 u. A stage 1/k! + r * next has an error
  // a <= 1.2 u + 0.2 (u + a') + u of its value, a < 3 u, for k >= 2; with the exact 1 of k = 1, u + 0.2 (u + 3 u) < 2
  // u; with that of k = 0, where |r * next| is at most 0.42 of the value, u + 0.42 (u + 2 u) < 2.3 u.
  const double series = polynomial(kFactorialReciprocals, r);
  return std::ldexp(series, static_cast<int>(n));
}

}  // namespace

double fast_arctangent_quotient(double t, Direction direction) {
  // atan t = 2 atan(t / c) with c = 1 + sqrt(1 + t^2), so that the quotient of t is 2/c times that of t / c; three
  // steps at most take t from 1 to 1/8. An error e of t gives t^2 / (1 + t^2) (2 e + u) + u <= e + 1.5 u under the
  // root, e/2 + 1.75 u after it and, as the root is at most 0.59 of c, 0.3 e + 2.1 u of c: 1.3 e + 3.1 u of the next t,
  // in turn 3.1 u, 7.2 u, 12.5 u; 0.3 e + 4.1 u of the factor in each step, 15.3 u in all.
  if (t == 0.0) return 1.0;
  double factor = 1.0;
  while (t > 0.125) {
    const double c = 1.0 + std::sqrt(1.0 + t * t);
    factor *= 2.0 / c;
    t /= c;
  }
  // What follows t^16/17 alternates and falls: below t^18/19 < 3e-18, 0.03 u. As q < 0.0157, 1 + q (...) has u of its
  // own, 0.0053 (25 u + 6 u) from q and from the stages before: below 1.3 u. The product: u. 18 u in all.
  const double q = t * t;
  const double quotient = factor * (1.0 + q * polynomial(kAlternatingReciprocals, q));
  // 2 u for the roundings of this line.
  constexpr double error = 24.0 * kRoundoff;
  return direction == Direction::up ? std::min(quotient * (1.0 + error), 1.0) : quotient * (1.0 - error);
}

double fast_power(double base, double exponent, Direction direction) {
  const bool up = direction == Direction::up;
  if (base == 1.0 || exponent == 0.0) return 1.0;
  if (base < 0x1p-1000) return power(base, exponent, direction);
  // 11 u of t.
  const double t = exponent * natural_logarithm(base);
  if (t > 700.0) return power(base, exponent, direction);
  if (t < -700.0) return up ? 1e-300 : 0.0;  // exp(-699) < 1e-303
  // exp turns the absolute error 11 u |t| into a relative one (times 1 + 1e-12) and adds 4 u of its own; the next two
  // lines make 2 u and some u^2.
  const double error = kRoundoff * (12.0 * std::fabs(t) + 8.0);
  const double value = natural_exponential(t) * (up ? 1.0 + error : 1.0 - error);
  // The exact power lies on the same side of 1 as the base.
  return (base < 1.0) == up ? (up ? std::min(value, 1.0) : std::max(value, 1.0)) : value;
}

}  // namespace verisq::verify
