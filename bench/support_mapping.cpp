/// Two powers a norm instead of the textbook formula's five, so that peers run as fast as their method allows.
#include "bench/support_mapping.hpp"

#include <algorithm>
#include <cmath>

namespace verisq::bench {
namespace {

/// Norm of two nonnegative numbers for the exponent q > 1, and its partial derivatives.
struct NormAndGradient {
  double norm;
  double by_first;
  double by_second;
};

/// With t = smaller / larger and T = 1 + t^q the norm is larger * T^(1/q), and (component / norm)^(q-1) follows from
/// T^(-(q-1)/q) = T^(1/q) / T.
NormAndGradient norm_and_gradient(double first, double second, double q) {
  const double larger = std::max(first, second);
  if (larger == 0.0) return {0.0, 0.0, 0.0};
  const double ratio = std::min(first, second) / larger;
  const double power = std::pow(ratio, q - 1.0);
  const double sum = 1.0 + ratio * power;
  const double root = std::pow(sum, 1.0 / q);
  const double of_larger = root / sum;
  const double of_smaller = power * of_larger;
  return first < second ? NormAndGradient{larger * root, of_smaller, of_larger}
                        : NormAndGradient{larger * root, of_larger, of_smaller};
}

}  // namespace

SupportMapping::SupportMapping(const Superquadric& solid)
    : semi_axes_(solid.semi_axes),
      section_conjugate_(2.0 / (2.0 - solid.exponents[1])),
      profile_conjugate_(2.0 / (2.0 - solid.exponents[0])) {}

Point SupportMapping::operator()(const Point& direction) const {
  const auto& [a1, a2, a3] = semi_axes_;
  const auto section = norm_and_gradient(a1 * std::abs(direction[0]), a2 * std::abs(direction[1]), section_conjugate_);
  const auto profile = norm_and_gradient(section.norm, a3 * std::abs(direction[2]), profile_conjugate_);
  return {std::copysign(a1 * section.by_first * profile.by_first, direction[0]),
          std::copysign(a2 * section.by_second * profile.by_first, direction[1]),
          std::copysign(a3 * profile.by_second, direction[2])};
}

}  // namespace verisq::bench
