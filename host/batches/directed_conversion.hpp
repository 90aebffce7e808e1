/// Numbers of many digits on their way to binary64: what the constants of kernels are computed in.
#pragma once

#include <boost/multiprecision/mpfr.hpp>
#include <cmath>

#include "verisq/enclosure.hpp"

namespace verisq::device {

using Extended =
    boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<60>, boost::multiprecision::et_off>;

[[nodiscard]] inline double round_down(const Extended& x) {
  const auto nearest = x.convert_to<double>();
  return Extended(nearest) <= x ? nearest : std::nextafter(nearest, -infinity);
}

[[nodiscard]] inline double round_up(const Extended& x) {
  return -round_down(-x);
}

}  // namespace verisq::device
