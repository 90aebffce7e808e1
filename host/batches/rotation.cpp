/// This file implements rotation matrices in long double.
#include "host/batches/rotation.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstddef>

namespace verisq::device {

// With v = 2^-64: squares and products of components carry one rounding, sums of four of them three more, so that
// numerators are off by at most 4.1 v n, n = |q|^2, the divisor by 4.1 v n, and the quotient, at most 1, by 9.3 v. The
// rounding to binary64 adds 2^-54: together less than 2^-53. Scaled to largest component 1, nothing overflows, and
// what underflows does not matter.
std::array<double, 9> rotation_matrix(const std::array<double, 4>& quaternion) {
  static_assert(LDBL_MANT_DIG >= 64, "the error bound needs 64 bits");
  double largest = 0.0;
  for (const double c : quaternion) largest = std::max(largest, std::abs(c));
  const int scale = -std::ilogb(largest);
  const auto component = [&](std::size_t i) { return std::scalbn(static_cast<long double>(quaternion[i]), scale); };
  const long double w = component(0);
  const long double x = component(1);
  const long double y = component(2);
  const long double z = component(3);
  const long double ww = w * w;
  const long double xx = x * x;
  const long double yy = y * y;
  const long double zz = z * z;
  const long double n = ww + xx + yy + zz;
  const auto entry = [n](long double numerator) { return static_cast<double>(numerator / n); };
  return {entry(ww + xx - yy - zz),   entry(2 * (x * y - w * z)), entry(2 * (x * z + w * y)),
          entry(2 * (x * y + w * z)), entry(ww - xx + yy - zz),   entry(2 * (y * z - w * x)),
          entry(2 * (x * z - w * y)), entry(2 * (y * z + w * x)), entry(ww - xx - yy + zz)};
}

}  // namespace verisq::device
