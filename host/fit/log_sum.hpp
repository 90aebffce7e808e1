/// Sums of numbers that are known by their logarithms, in plain binary64.
#pragma once

#include <algorithm>
#include <cmath>

namespace verisq::fit_search {

/// log(e^a + e^b) and the share of e^b in the sum.
struct LogSum {
  double value, share;
};

[[nodiscard]] inline LogSum log_sum(double a, double b) {
  const double smaller = std::exp(-std::fabs(a - b));
  const double larger_share = 1.0 / (1.0 + smaller);
  return {std::max(a, b) + std::log1p(smaller), b > a ? larger_share : smaller * larger_share};
}

/// Squares of e^+-300 are normal numbers.
[[nodiscard]] inline double bounded_exp(double x) {
  return std::exp(std::clamp(x, -300.0, 300.0));
}

}  // namespace verisq::fit_search
