/// Coefficients of Taylor series by recurrence: what automatic differentiation of an ordinary differential equation
/// needs.
#pragma once

#include <cstddef>
#include <vector>

namespace verisq::stance {

/// The first coefficients of a function's series, so many as are known yet.
template <class T>
using Series = std::vector<T>;

/// Coefficient k of the product of two series. Precondition: both are known up to k.
template <class T>
[[nodiscard]] T product_coefficient(const Series<T>& a, const Series<T>& b, std::size_t k) {
  T sum = a[0] * b[k];
  for (std::size_t i = 1; i <= k; ++i) sum += a[i] * b[k - i];
  return sum;
}

}  // namespace verisq::stance
