/// MPFR's directed sin, cos and atan; extrema by counting half turns; quotients by bracketing series near 0.
#include "verify/analysis/trigonometry.hpp"

#include <algorithm>
#include <type_traits>

namespace verisq::verify {

namespace {

/// MPFR's number for T, and the value back in T rounded in the same direction (as in real.cpp).
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

/// Of a function of one variable at a point.
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

/// A wave of period 2 pi whose maxima lie where `phase`, in half turns, is an even integer and whose minima where it is
/// an odd one, from its range at the ends. `phase` may contain too much, which only widens the result.
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

}  // namespace verisq::verify
