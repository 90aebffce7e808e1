/// The length of a vector of binary64 numbers, with a bound of its error that rests on correctly rounded operations
/// alone.
#pragma once

#include <algorithm>
#include <cmath>

namespace verisq::verify {

/// Within 2^-50 of the Euclidean length, relatively, and 2^-1074; NaN or infinity where a component is, or on overflow.
/// Not std::hypot, whose accuracy is each library's own. With u = 2^-53 and quotients by the largest component m, of
/// which one is 1: each quotient rounds by u, its square by u more, two sums by u each, so that their root is off by
/// 5u/2; root and product round by u each. These 9u/2 < 2^-50 leave room for the products of errors and for the squares
/// that underflow beside 1; a subnormal product rounds by 2^-1075.
[[nodiscard]] inline double length(double x, double y, double z) {
  const double m = std::max({std::fabs(x), std::fabs(y), std::fabs(z)});
  if (m == 0.0) return x + y + z;  // 0, or NaN
  const double a = x / m;
  const double b = y / m;
  const double c = z / m;
  return m * std::sqrt(a * a + b * b + c * c);
}

}  // namespace verisq::verify
