/// Zero area by a floating-point filter, and by rational arithmetic for the few triangles that the filter leaves open.
#include "host/files/triangle_area.hpp"

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <limits>
#include <utility>

namespace verisq {
namespace {

using Rational = boost::multiprecision::cpp_rational;

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

bool exactly_zero_area(const Point& a, const Point& b, const Point& c) {
  std::array<Rational, 3> ab;
  std::array<Rational, 3> ac;
  for (std::size_t k = 0; k < 3; ++k) {
    ab[k] = Rational(b[k]) - Rational(a[k]);
    ac[k] = Rational(c[k]) - Rational(a[k]);
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
