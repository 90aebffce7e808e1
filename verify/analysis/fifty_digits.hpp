/// Floating point of 50 decimal digits for proposals, exchanged exactly or to nearest with the numbers of proofs.
#pragma once

#include <boost/multiprecision/eigen.hpp>
#include <boost/multiprecision/mpfr.hpp>

#include "verify/numbers/real.hpp"

namespace verisq::verify {

using FiftyDigits =
    boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<50, boost::multiprecision::allocate_stack>,
                                  boost::multiprecision::et_off>;

/// To nearest.
[[nodiscard]] inline Real to_real(const FiftyDigits& x) {
  Real result;
  mpfr_set(result.get(), x.backend().data(), MPFR_RNDN);
  return result;
}

/// Exact.
[[nodiscard]] inline FiftyDigits to_fifty_digits(const Real& x) {
  FiftyDigits result;
  mpfr_set(result.backend().data(), x.get(), MPFR_RNDN);
  return result;
}

}  // namespace verisq::verify
