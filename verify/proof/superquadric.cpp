/// Mixed norms, one side at a time.
#include "verify/proof/superquadric.hpp"

#include <cmath>
#include <type_traits>

#include "verify/numbers/fast_functions.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

/// p = 2/e
template <class T>
NormExponent<T> primal_exponent(double e) {
  const BasicInterval<T> exponent{T(e)};
  return {BasicInterval<T>(2) / exponent, exponent / BasicInterval<T>(2)};
}

/// q = 2/(2 - e), the conjugate of 2/e
template <class T>
NormExponent<T> dual_exponent(double e) {
  if (e == 2.0) return {BasicInterval<T>(1), BasicInterval<T>(1), true};
  const BasicInterval<T> difference = BasicInterval<T>(2) - BasicInterval<T>(T(e));
  return {BasicInterval<T>(2) / difference, difference / BasicInterval<T>(2)};
}

double bound_of_power(double base, double exponent, Direction direction) {
  return fast_power(base, exponent, direction);
}

Real bound_of_power(const Real& base, const Real& exponent, Direction direction) {
  return power(base, exponent, direction);
}

/// An e with x < 2^e, for x > 0.
double binary_exponent(double x) {
  return std::ilogb(x) + 1.0;
}

double binary_exponent(const Real& x) {
  return static_cast<double>(mpfr_get_exp(x.get()));
}

double below(double x) {
  return x;
}

double below(const Real& x) {
  return x.to_double(Direction::down);
}

/// Whether ratio^p is proven to be too small to change 1 but for one rounding, for 0 <= ratio <= 1 and p >= 1.
template <class T>
bool is_negligible(const T& ratio, const NormExponent<T>& p) {
  // Four bits and more beyond the precision: the rounding of this product does not matter.
  constexpr double limit = std::is_same_v<T, double> ? -58.0 : -132.0;
  return ratio == T(0) || binary_exponent(ratio) * below(p.value.lower()) < limit;
}

/// (1 + ratio^p)^(1/p) for 0 <= ratio <= 1
template <class T>
T norm_of_ratio(const T& ratio, const NormExponent<T>& p, Direction direction) {
  const bool up = direction == Direction::up;
  if (p.value.lower() == T(1) && p.value.upper() == T(1)) return add(T(1), ratio, direction);
  if (p.value.lower() == T(2) && p.value.upper() == T(2)) {
    return square_root(add(T(1), multiply(ratio, ratio, direction), direction), direction);
  }
  if (is_negligible(ratio, p)) return add(T(1), up ? T(0x1p-500) : T(0), direction);
  // Falls with p because ratio <= 1.
  const T term = bound_of_power(ratio, up ? p.value.lower() : p.value.upper(), direction);
  // Rises with 1/p because the base is at least 1.
  const T sum = add(T(1), term, direction);
  return bound_of_power(sum, up ? p.reciprocal.upper() : p.reciprocal.lower(), direction);
}

/// A bound of (x^p + y^p)^(1/p) for nonnegative x and y. The larger operand is factored out: every power has a base in
/// [0, 1] or [1, 2], nothing overflows, and the small term's large relative error does no harm.
template <class T>
T norm(const T& x, const T& y, const NormExponent<T>& p, Direction direction) {
  const T& large = x < y ? y : x;
  const T& small = x < y ? x : y;
  if (p.infinite || small == T(0) || large == T(infinity)) return large;
  // A quotient below 1 rounds to at most 1.
  return multiply(large, norm_of_ratio<T>(divide(small, large, direction), p, direction), direction);
}

}  // namespace

template <class T>
SuperquadricBounds<T>::SuperquadricBounds(const Superquadric& superquadric)
    : semi_axes_{T(superquadric.semi_axes[0]), T(superquadric.semi_axes[1]), T(superquadric.semi_axes[2])},
      inner_(primal_exponent<T>(superquadric.exponents[1])),
      outer_(primal_exponent<T>(superquadric.exponents[0])),
      dual_inner_(dual_exponent<T>(superquadric.exponents[1])),
      dual_outer_(dual_exponent<T>(superquadric.exponents[0])) {}

template <class T>
T SuperquadricBounds<T>::section(const T& x, const T& y, Direction direction) const {
  return norm(divide(x, semi_axes_[0], direction), divide(y, semi_axes_[1], direction), inner_, direction);
}

template <class T>
T SuperquadricBounds<T>::gauge(const T& section, const T& z, Direction direction) const {
  return norm(section, divide(z, semi_axes_[2], direction), outer_, direction);
}

template <class T>
T SuperquadricBounds<T>::gauge(const std::array<T, 3>& coordinates, Direction direction) const {
  return gauge(section(coordinates[0], coordinates[1], direction), coordinates[2], direction);
}

template <class T>
T SuperquadricBounds<T>::support(const std::array<T, 3>& coordinates, Direction direction) const {
  const T x = multiply(coordinates[0], semi_axes_[0], direction);
  const T y = multiply(coordinates[1], semi_axes_[1], direction);
  const T z = multiply(coordinates[2], semi_axes_[2], direction);
  return norm(norm(x, y, dual_inner_, direction), z, dual_outer_, direction);
}

template <class T>
BasicInterval<T> SuperquadricBounds<T>::gauge(const Vector3<T>& x) const {
  return {gauge(magnitudes<T>(x, Direction::down), Direction::down),
          gauge(magnitudes<T>(x, Direction::up), Direction::up)};
}

template <class T>
BasicInterval<T> SuperquadricBounds<T>::support(const Vector3<T>& v) const {
  return {support(magnitudes<T>(v, Direction::down), Direction::down),
          support(magnitudes<T>(v, Direction::up), Direction::up)};
}

template class SuperquadricBounds<double>;
template class SuperquadricBounds<Real>;

}  // namespace verisq::verify
