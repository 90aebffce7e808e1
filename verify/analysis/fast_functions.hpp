/// Elementary functions bounded in plain binary64 arithmetic with a-priori errors: for search, where MPFR would take
/// most of the time.
#pragma once

#include "verify/numbers/rounding.hpp"

namespace verisq::verify {

/// A bound of base^exponent for 0 <= base <= 2 and exponent >= 0, on the side `direction`. Off by at most
/// (12 |log(base^exponent)| + 8) 2^-52 of the result where that is above 1e-300, and never beyond 1.
[[nodiscard]] double fast_power(double base, double exponent, Direction direction);

/// A bound of atan(t)/t for 0 <= t <= 1, off by at most 2^-48 of the result and never above 1.
[[nodiscard]] double fast_arctangent_quotient(double t, Direction direction);

}  // namespace verisq::verify
