/// This file implements functions.hpp.
#include "verify/numbers/functions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <type_traits>

#include "verify/numbers/real.hpp"

namespace verisq::verify {

namespace {

using Binary64 = MpfrNumber<DBL_MANT_DIG>;

}  // namespace

bool is_integer(double a) {
  return std::isfinite(a) && std::trunc(a) == a;
}

double exponential(double a, Direction direction) {
  return exponential(Binary64(a), direction).to_double(direction);
}

double logarithm(double a, Direction direction) {
  return logarithm(Binary64(a), direction).to_double(direction);
}

double logarithm_1p(double a, Direction direction) {
  return logarithm_1p(Binary64(a), direction).to_double(direction);
}

double power(double base, double exponent, Direction direction) {
  return power(Binary64(base), Binary64(exponent), direction).to_double(direction);
}

namespace {

/// MPFR's number for T, and the value back in T rounded in the same direction (as in real.hpp).
template <class T>
using Mpfr = std::conditional_t<std::is_same_v<T, double>, MpfrNumber<DBL_MANT_DIG>, Real>;

double from_mpfr(const MpfrNumber<DBL_MANT_DIG>& a, Direction direction) {
  return a.to_double(direction);
}

Real from_mpfr(const Real& a, Direction /*direction*/) {
  return a;
}

template <class T, class Operation, class... Operands>
T directed(Operation operation, Direction direction, Operands... operands) {
  release_mpfr_cache_at_thread_exit();
  Mpfr<T> result;
  operation(result.get(), operands..., mpfr_rounding(direction));
  return from_mpfr(result, direction);
}

/// Encloses a function of one variable at a point.
template <class T, class Operation>
BasicInterval<T> enclosure(Operation operation, const T& a) {
  const Mpfr<T> operand(a);
  return {directed<T>(operation, Direction::down, operand.get()), directed<T>(operation, Direction::up, operand.get())};
}

/// The function at both ends: the range of a monotone one, and of any without its inner extrema.
template <class T, class Operation>
BasicInterval<T> hull_at_ends(Operation operation, const BasicInterval<T>& a) {
  const BasicInterval<T> lower = enclosure(operation, a.lower());
  return a.lower() == a.upper() ? lower : hull(lower, enclosure(operation, a.upper()));
}

PreciseInterval half_turns(double lower, double upper) {
  return PreciseInterval(Real(lower), Real(upper)) / pi<Real>();
}

PreciseInterval half_turns(const Real& lower, const Real& upper) {
  return PreciseInterval(lower, upper) / pi<Real>();
}

Real rounded_to_integer_above(const Real& a) {
  Real result;
  mpfr_ceil(result.get(), a.get());
  return result;
}

bool is_even(const Real& integer) {
  return is_integer(divide(integer, Real(2), Direction::down));
}

/// The range of a wave of period 2 pi over an interval, from its range at the ends. Its maxima lie where `phase`, in
/// half turns, is an even integer, its minima where it is odd. `phase` may contain too much, which only widens the
/// result.
template <class T>
BasicInterval<T> with_extrema(const BasicInterval<T>& at_ends, const PreciseInterval& phase) {
  const Real first = rounded_to_integer_above(phase.lower());
  if (first > phase.upper()) return at_ends;
  const Real second = add(first, Real(1), Direction::up);
  if (second <= phase.upper()) return {T(-1), T(1)};
  return hull(at_ends, BasicInterval<T>(is_even(first) ? 1 : -1));
}

/// Within this the 127 bits of a number of half turns leave 67 behind the point.
template <class T>
bool is_moderate(const BasicInterval<T>& angle) {
  const T limit(0x1p60);
  return angle.lower() >= -limit && angle.upper() <= limit;
}

/// 1 - a^2 / divisor <= quotient <= 1: the first terms of an alternating series whose terms fall for |a| <= 1.
template <class T>
BasicInterval<T> quotient_near_zero(const T& a, int divisor) {
  const T square = divide(multiply(a, a, Direction::up), T(divisor), Direction::up);
  return {subtract(T(1), square, Direction::down), T(1)};
}

/// f(a)/a for an odd f with the series a - a^3 / divisor + ..., 0 < f(a) <= a for a in (0, pi]. Below the limit the
/// series is as good as the arithmetic, and f may underflow.
template <class T, class Operation>
BasicInterval<T> odd_quotient(Operation operation, const T& a, int divisor) {
  const T limit(std::is_same_v<T, double> ? 0x1p-30 : 0x1p-68);
  if (a <= limit) return quotient_near_zero(a, divisor);
  const BasicInterval<T> quotient = enclosure(operation, a) / BasicInterval<T>(a);
  return {std::min(quotient.lower(), T(1)), std::min(quotient.upper(), T(1))};
}

/// polar_angle() for y >= 0, within [0, pi]: falls with x, and with y rises where x > 0 and falls where x < 0.
template <class T>
BasicInterval<T> angle_above(const BasicInterval<T>& x, const BasicInterval<T>& y) {
  const T zero(0);
  const T half_turn = pi<T>().upper();
  // The origin alone: nothing is known. Otherwise it is beside points that have an angle, which bound the others.
  if (x.lower() == zero && x.upper() == zero && y.upper() == zero) return {zero, half_turn};
  if (x.upper() == zero && y.upper() == zero) return pi<T>();
  const auto angle = [&](const T& ordinate, const T& abscissa, Direction direction) {
    const auto unsigned_zero = [&](const T& a) { return Mpfr<T>(a == zero ? zero : a); };  // MPFR tells -0 from 0
    return directed<T>(mpfr_atan2, direction, unsigned_zero(ordinate).get(), unsigned_zero(abscissa).get());
  };
  return {angle(x.upper() > zero ? y.lower() : y.upper(), x.upper(), Direction::down),
          angle(x.lower() < zero ? y.lower() : y.upper(), x.lower(), Direction::up)};
}

}  // namespace

template <class T>
BasicInterval<T> pi() {
  return {directed<T>(mpfr_const_pi, Direction::down), directed<T>(mpfr_const_pi, Direction::up)};
}

template <class T>
BasicInterval<T> sin(const BasicInterval<T>& angle) {
  if (!is_moderate(angle)) return {T(-1), T(1)};
  // sin a = cos(a - pi/2)
  const PreciseInterval phase = half_turns(angle.lower(), angle.upper()) - PreciseInterval(Real(0.5));
  return with_extrema(hull_at_ends(mpfr_sin, angle), phase);
}

template <class T>
BasicInterval<T> cos(const BasicInterval<T>& angle) {
  if (!is_moderate(angle)) return {T(-1), T(1)};
  return with_extrema(hull_at_ends(mpfr_cos, angle), half_turns(angle.lower(), angle.upper()));
}

template <class T>
BasicInterval<T> atan(const BasicInterval<T>& a) {
  return hull_at_ends(mpfr_atan, a);
}

template <class T>
BasicInterval<T> sine_quotient(const BasicInterval<T>& a) {
  const BasicInterval<T> magnitude = abs(a);
  // Falls with |a| up to pi; beyond it |sin a / a| < 1/pi.
  const T half_turn = pi<T>().lower();
  const BasicInterval<T> upper = odd_quotient(mpfr_sin, std::min(magnitude.lower(), half_turn), 6);
  if (magnitude.upper() <= half_turn) return {odd_quotient(mpfr_sin, magnitude.upper(), 6).lower(), upper.upper()};
  if (magnitude.lower() <= half_turn) return {T(-0.5), std::max(upper.upper(), T(0.5))};
  return sin(magnitude) / magnitude;
}

template <class T>
BasicInterval<T> arctangent_quotient(const BasicInterval<T>& a) {
  const BasicInterval<T> magnitude = abs(a);
  const BasicInterval<T> largest = odd_quotient(mpfr_atan, magnitude.lower(), 3);
  if (magnitude.lower() == magnitude.upper()) return largest;
  return {odd_quotient(mpfr_atan, magnitude.upper(), 3).lower(), largest.upper()};
}

template <class T>
BasicInterval<T> polar_angle(const BasicInterval<T>& x, const BasicInterval<T>& y) {
  const T zero(0);
  if (y.lower() >= zero) return angle_above(x, y);
  const T half_turn = pi<T>().upper();
  if (x.lower() < zero && y.upper() >= zero) return {-half_turn, half_turn};  // meets the cut
  if (y.upper() <= zero) return -angle_above(x, -y);
  return hull(-angle_above<T>(x, {zero, -y.lower()}), angle_above<T>(x, {zero, y.upper()}));
}

template <class T>
BasicInterval<T> sin_of_degrees(double degrees) {
  const auto sine = [](mpfr_ptr result, mpfr_srcptr angle, mpfr_rnd_t rounding) {
    return mpfr_sinu(result, angle, 360, rounding);
  };
  return enclosure(sine, T(degrees));
}

template <class T>
BasicInterval<T> cos_of_degrees(double degrees) {
  const auto cosine = [](mpfr_ptr result, mpfr_srcptr angle, mpfr_rnd_t rounding) {
    return mpfr_cosu(result, angle, 360, rounding);
  };
  return enclosure(cosine, T(degrees));
}

template BasicInterval<double> sin(const BasicInterval<double>&);
template BasicInterval<Real> sin(const BasicInterval<Real>&);
template BasicInterval<double> cos(const BasicInterval<double>&);
template BasicInterval<Real> cos(const BasicInterval<Real>&);
template BasicInterval<double> atan(const BasicInterval<double>&);
template BasicInterval<Real> atan(const BasicInterval<Real>&);
template BasicInterval<double> sine_quotient(const BasicInterval<double>&);
template BasicInterval<Real> sine_quotient(const BasicInterval<Real>&);
template BasicInterval<double> arctangent_quotient(const BasicInterval<double>&);
template BasicInterval<Real> arctangent_quotient(const BasicInterval<Real>&);
template BasicInterval<double> polar_angle(const BasicInterval<double>&, const BasicInterval<double>&);
template BasicInterval<Real> polar_angle(const BasicInterval<Real>&, const BasicInterval<Real>&);
template BasicInterval<double> pi();
template BasicInterval<Real> pi();
template BasicInterval<double> sin_of_degrees(double);
template BasicInterval<Real> sin_of_degrees(double);
template BasicInterval<double> cos_of_degrees(double);
template BasicInterval<Real> cos_of_degrees(double);

namespace {

// Below, u = 2^-53 bounds the relative error of each operation. Nothing here overflows, and every number that
// underflows (a squared small number, a tiny logarithm) is added to 1.

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

/// The polynomial by Horner's rule, the highest coefficient first.
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
  // 1 + q/3 + ... + q^10/21; the remaining terms are below q^11/23/(1 - q) < 1e-18. All terms are positive. With q <=
  // 0.0295 each stage passes on less than 0.03 (5 u + u + the error of the stage before), which leaves 1.5 u for the
  // last one.
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
  // Taylor's series to r^13; the remaining terms are below 0.35^14 e^0.35 / 14! < 1e-17, 0.1 u. A stage 1/k! + r * next
  // has an error a <= 1.2 u + 0.2 (u + a') + u of its value, so a < 3 u, for k >= 2. The stage with the exact 1 of k =
  // 1 has u + 0.2 (u + 3 u) < 2 u. The stage of k = 0, where |r * next| is at most 0.42 of the value, has u + 0.42 (u +
  // 2 u) < 2.3 u.
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
  // The terms after t^16/17 alternate and fall: together they are below t^18/19 < 3e-18, 0.03 u. As q < 0.0157, 1 + q
  // (...) rounds by u itself, and 0.0053 (25 u + 6 u) come from q and from the stages before: below 1.3 u. The product
  // rounds by u. In all: 18 u.
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
