/// This file implements directed rounding by MPFR at 53 bits. MPFR's exponents reach further than those of binary64;
/// rounding a second time in the same direction is rounding once.
#include "host/arithmetic/exact_rounding.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "verify/numbers/real.hpp"

namespace verisq::device::exact {
namespace {

using Binary64 = verify::MpfrNumber<53>;

template <class Operation, class... Operands>
double rounded(Operation operation, Direction direction, Operands... operands) {
  return verify::rounded_result<53>(operation, direction, Binary64(operands).get()...).to_double(direction);
}

/// 2^1024 where x is infinite, halved so that it is a number.
double half(double x) {
  return std::isinf(x) ? std::copysign(0x1p1023, x) : x / 2.0;
}

}  // namespace

double sum(double a, double b, Direction direction) {
  return rounded(mpfr_add, direction, a, b);
}

double difference(double a, double b, Direction direction) {
  return rounded(mpfr_sub, direction, a, b);
}

double product(double a, double b, Direction direction) {
  return a == 0.0 || b == 0.0 ? 0.0 : rounded(mpfr_mul, direction, a, b);
}

double quotient(double a, double b, Direction direction) {
  return rounded(mpfr_div, direction, a, b);
}

double fused(double a, double b, double c, Direction direction) {
  return a == 0.0 || b == 0.0 ? c : rounded(mpfr_fma, direction, a, b, c);
}

double root(double a, Direction direction) {
  return rounded(mpfr_sqrt, direction, a);
}

double exponential(double a, Direction direction) {
  verify::release_mpfr_cache_at_thread_exit();
  return rounded(mpfr_exp, direction, a);
}

double logarithm(double a, Direction direction) {
  verify::release_mpfr_cache_at_thread_exit();
  return rounded(mpfr_log, direction, a);
}

double power(double base, double exponent, Direction direction) {
  verify::release_mpfr_cache_at_thread_exit();
  return rounded(mpfr_pow, direction, base == 0.0 ? 0.0 : base, exponent);  // to MPFR -0 is negative
}

/// The arc is rounded too, in the same direction, but 200 bits further right: no binary64 number lies in between.
double inverse_tangent_ratio(double a, Direction direction) {
  verify::release_mpfr_cache_at_thread_exit();
  if (a == 0.0) return 1.0;
  const verify::MpfrNumber<256> size(std::abs(a));
  const auto arc = verify::rounded_result<256>(mpfr_atan, direction, size.get());
  return verify::rounded_result<53>(mpfr_div, direction, arc.get(), size.get()).to_double(direction);
}

double last_place(double rounded_down, double rounded_up) {
  const double size = std::min(std::abs(rounded_down), std::abs(rounded_up));
  if (!(size >= std::numeric_limits<double>::min())) return 0x1p-1022;
  const double capped = std::min(size, std::numeric_limits<double>::max());
  return std::max(std::ldexp(1.0, std::ilogb(capped) - 52), 0x1p-1022);
}

double units_outside(double bound, double tightest, double last_place, Direction direction) {
  if (bound == tightest) return 0.0;
  const double outside = direction == Direction::down ? half(tightest) - half(bound) : half(bound) - half(tightest);
  return outside / (last_place / 2.0);
}

}  // namespace verisq::device::exact
