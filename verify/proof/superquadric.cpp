/// The bounds in 127 bits.
#include "verify/proof/superquadric.hpp"

#include "verify/proof/mixed_norm.hpp"

namespace verisq::verify {

Real bound_of_power(const Real& base, const Real& exponent, Direction direction) {
  return power(base, exponent, direction);
}

template class SuperquadricBounds<Real>;

PreciseVector focus(const Superquadric& superquadric) {
  return {0, 0, -(TaperNumbers<Real>(superquadric.taper).k * PreciseInterval(Real(superquadric.semi_axes[2])))};
}

}  // namespace verisq::verify
