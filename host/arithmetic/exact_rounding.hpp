/// The exact value of an operation, rounded once in a given direction: the tightest binary64 bound there is, by MPFR.
#pragma once

#include "verify/numbers/rounding.hpp"

namespace verisq::device::exact {

using verify::Direction;

// Operands are bounds of real numbers, as in verify/numbers/rounding.hpp: 0 times an infinity is 0. Shares no code with
// the functions there, which the accuracy report measures against these.

[[nodiscard]] double sum(double a, double b, Direction direction);
[[nodiscard]] double difference(double a, double b, Direction direction);
[[nodiscard]] double product(double a, double b, Direction direction);
/// NaN for 0 / 0 and for two infinities; otherwise the sign of a zero divisor is that of the infinite quotient.
[[nodiscard]] double quotient(double a, double b, Direction direction);
/// a b + c
[[nodiscard]] double fused(double a, double b, double c, Direction direction);
[[nodiscard]] double root(double a, Direction direction);
[[nodiscard]] double exponential(double a, Direction direction);
[[nodiscard]] double logarithm(double a, Direction direction);
/// base^exponent for base >= 0; 0^0 = 1.
[[nodiscard]] double power(double base, double exponent, Direction direction);
/// atan(a)/a, 1 at 0 and 0 at the infinities.
[[nodiscard]] double inverse_tangent_ratio(double a, Direction direction);

/// The last place of the exact value whose roundings down and up these are: the distance of the two binary64 numbers
/// around it; where it is one itself, of those above its magnitude. At least 2^-1022, the slack of
/// kernels/rounding.clh.
[[nodiscard]] double last_place(double rounded_down, double rounded_up);

/// How far `bound` lies outside `tightest`, in units of `last_place`; infinite bounds count as 2^1024. Negative where
/// it lies inside: there it bounds nothing.
[[nodiscard]] double units_outside(double bound, double tightest, double last_place, Direction direction);

}  // namespace verisq::device::exact
