/// This file implements rounding.hpp.
#include "verify/numbers/rounding.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

/// Below this the residual of a product or quotient of 53-bit numbers may itself underflow (2^-1022 * 2^53 = 2^-969).
constexpr double kResidualIsExactAbove = 0x1p-960;

/// Moves the rounded result one step if the sign of (exact - rounded) shows that it lies on the wrong side.
double correct(double rounded, double residual, Direction direction) {
  if (direction == Direction::down && residual < 0.0) return std::nextafter(rounded, -infinity);
  if (direction == Direction::up && residual > 0.0) return std::nextafter(rounded, infinity);
  return rounded;
}

/// The rounded result of finite operands overflowed: the exact result is finite, beyond the largest binary64 number.
double overflowed(double infinite, Direction direction) {
  const bool away_from_zero = (infinite > 0.0) == (direction == Direction::up);
  return away_from_zero ? infinite : std::copysign(std::numeric_limits<double>::max(), infinite);
}

/// A finite nonzero number as mantissa * 2^exponent with 1/2 <= |mantissa| < 1; exact for subnormals too.
struct Scaled {
  double mantissa;
  int exponent;
};

Scaled scaled(double value) {
  Scaled result{};
  result.mantissa = std::frexp(value, &result.exponent);
  return result;
}

}  // namespace

double add(double a, double b, Direction direction) {
  const double sum = a + b;
  if (!std::isfinite(sum)) return std::isfinite(a) && std::isfinite(b) ? overflowed(sum, direction) : sum;
  // Fast2Sum (Dekker): exact for |a| >= |b|, also for subnormals, and free of spurious overflow.
  if (std::fabs(a) < std::fabs(b)) std::swap(a, b);
  return correct(sum, b - (sum - a), direction);
}

double subtract(double a, double b, Direction direction) {
  return add(a, -b, direction);
}

double multiply(double a, double b, Direction direction) {
  if (a == 0.0 || b == 0.0) return 0.0;
  const double product = a * b;
  if (!std::isfinite(product)) return std::isfinite(a) && std::isfinite(b) ? overflowed(product, direction) : product;
  if (std::fabs(product) > kResidualIsExactAbove) return correct(product, std::fma(a, b, -product), direction);
  // The same residual, scaled into the normal range. `product` scales exactly (upwards) and lies within a factor of two
  // of the exact product or is zero. So the difference of the leading parts is exact. The sign of the final sum of two
  // numbers is exact because nothing underflows here.
  const Scaled x = scaled(a);
  const Scaled y = scaled(b);
  const double leading = x.mantissa * y.mantissa;
  const double trailing = std::fma(x.mantissa, y.mantissa, -leading);
  const double rounded = std::ldexp(product, -(x.exponent + y.exponent));
  return correct(product, (leading - rounded) + trailing, direction);
}

double divide(double a, double b, Direction direction) {
  const double quotient = a / b;
  if (!std::isfinite(quotient)) {
    return std::isfinite(a) && std::isfinite(b) && b != 0.0 ? overflowed(quotient, direction) : quotient;
  }
  if (a == 0.0 || std::isinf(b)) return quotient;
  // exact - rounded = (a - rounded * b) / b; one fma gives the sign of the numerator unless it underflows.
  if (std::fabs(a) > kResidualIsExactAbove && std::fabs(quotient) > kResidualIsExactAbove) {
    return correct(quotient, std::copysign(1.0, b) * std::fma(-quotient, b, a), direction);
  }
  const Scaled x = scaled(a);
  const Scaled y = scaled(b);
  // Exact: either the quotient is small and scales upwards, or it is a normal number near mantissa size.
  const double rounded = std::ldexp(quotient, y.exponent - x.exponent);
  const double residual = std::fma(-rounded, y.mantissa, x.mantissa);
  return correct(quotient, std::copysign(1.0, y.mantissa) * residual, direction);
}

double square_root(double a, Direction direction) {
  const double root = std::sqrt(a);
  if (!std::isfinite(root) || a == 0.0) return root;
  if (a > kResidualIsExactAbove) return correct(root, std::fma(-root, root, a), direction);
  // Scaled by 2^200 (exact), the root by 2^100: the residual is a normal number or zero.
  const double rounded = root * 0x1p100;
  return correct(root, std::fma(-rounded, rounded, a * 0x1p200), direction);
}

}  // namespace verisq::verify
