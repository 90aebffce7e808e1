/// Zero area by a floating-point filter, and by integer arithmetic for the few triangles that the filter leaves open.
#include "host/files/triangle_area.hpp"

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace verisq {
namespace {

using Integer = boost::multiprecision::cpp_int;

constexpr std::array<std::pair<int, int>, 3> planes{{{0, 1}, {1, 2}, {2, 0}}};

/// Shewchuk's filter for orient2d (Discrete & Computational Geometry 18, 1997): where the rounded determinant exceeds
/// (3 + 16u)u times the sum of its rounded products, u = 2^-53, it is not zero. Here 8u, and far more than
/// underflow can hide. Overflow gives infinity > infinity or NaN, which is false: left to the exact test.
bool surely_positive_area(const Point& a, const Point& b, const Point& c) {
  constexpr double relative = 4.0 * std::numeric_limits<double>::epsilon();
  constexpr double underflow = 1e-300;
  return std::any_of(planes.begin(), planes.end(), [&](const auto& plane) {
    const auto [i, j] = plane;
    const double left = (b[i] - a[i]) * (c[j] - a[j]);
    const double right = (b[j] - a[j]) * (c[i] - a[i]);
    return std::abs(left - right) > relative * (std::abs(left) + std::abs(right)) + underflow;
  });
}

/// `x` in units of 2^-1126: every finite binary64 number is a mantissa of 53 bits times 2^e with e >= -1073 - 53, the
/// exponent that frexp gives the least subnormal. Integers, since rationals spend all their time on common divisors.
Integer in_small_units(double x) {
  int exponent = 0;
  const double fraction = std::frexp(x, &exponent);
  const auto mantissa = static_cast<std::int64_t>(std::ldexp(fraction, 53));
  return mantissa == 0 ? Integer(0) : Integer(mantissa) << (exponent - 53 + 1126);
}

/// Whether area is zero does not depend on the unit.
bool exactly_zero_area(const Point& a, const Point& b, const Point& c) {
  std::array<Integer, 3> ab;
  std::array<Integer, 3> ac;
  for (std::size_t k = 0; k < 3; ++k) {
    const Integer corner = in_small_units(a[k]);
    ab[k] = in_small_units(b[k]) - corner;
    ac[k] = in_small_units(c[k]) - corner;
  }
  for (const auto& [i, j] : planes) {
    if (ab[i] * ac[j] != ab[j] * ac[i]) return false;
  }
  return true;
}

}  // namespace

bool has_zero_area(const Point& a, const Point& b, const Point& c) {
  return !surely_positive_area(a, b, c) && exactly_zero_area(a, b, c);
}

}  // namespace verisq
