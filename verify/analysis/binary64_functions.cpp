/// Elementary functions of binary64 by MPFR, for searches: proofs of single answers know only longer numbers.
#include <cmath>

#include "verify/analysis/exponential.hpp"

namespace verisq::verify {

namespace {

using Binary64 = MpfrNumber<DBL_MANT_DIG>;

}  // namespace

bool is_integer(double a) {
  return std::isfinite(a) && std::trunc(a) == a;
}

double exponential(double a, Direction direction) {
  return exponential(Binary64(a), direction).to_double(direction);
}

double logarithm(double a, Direction direction) {
  return logarithm(Binary64(a), direction).to_double(direction);
}

double logarithm_1p(double a, Direction direction) {
  return logarithm_1p(Binary64(a), direction).to_double(direction);
}

double power(double base, double exponent, Direction direction) {
  return power(Binary64(base), Binary64(exponent), direction).to_double(direction);
}

}  // namespace verisq::verify
