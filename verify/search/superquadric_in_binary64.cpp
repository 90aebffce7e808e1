/// The bounds of a superquadric in binary64, for searches that ask for them often.
#include "verify/analysis/fast_functions.hpp"
#include "verify/proof/mixed_norm.hpp"

namespace verisq::verify {

double bound_of_power(double base, double exponent, Direction direction) {
  return fast_power(base, exponent, direction);
}

template class SuperquadricBounds<double>;

}  // namespace verisq::verify
