/// The bounds in 127 bits.
#include "verify/proof/superquadric.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "verify/proof/mixed_norm.hpp"

namespace verisq::verify {

Real bound_of_power(const Real& base, const Real& exponent, Direction direction) {
  return power(base, exponent, direction);
}

template class SuperquadricBounds<Real>;

// f(τ) = ‖(r, Z + k τ)‖ - τ is convex and not negative at the start, from where Newton ascends to the root: with the
// maximum norm it is there.
template <class Float>
Float near_root_of_support(Float section, Float height, Float k, Float q) {
  Float root = std::max({section, height / (1 - k), -height / (1 + k)});
  for (int i = 0; i < 60 && q < infinity && root > 0; ++i) {
    const Float moved = height + k * root;
    const Float large = std::max(section, std::fabs(moved));
    const Float small = std::min(section, std::fabs(moved));
    const Float norm = large * std::pow(1 + std::pow(small / large, q), 1 / q);
    const Float slope = std::copysign(k, k * moved) * std::pow(std::fabs(moved) / norm, q - 1) - 1;
    const Float step = (root - norm) / slope;
    root += step;
    if (!(step > 4 * std::numeric_limits<Float>::epsilon() * root)) break;
  }
  return root;
}

template double near_root_of_support(double, double, double, double);
template long double near_root_of_support(long double, long double, long double, long double);

PreciseVector focus(const Superquadric& superquadric) {
  return {0, 0, -(TaperNumbers<Real>(superquadric.taper).k * PreciseInterval(Real(superquadric.semi_axes[2])))};
}

}  // namespace verisq::verify
