/// Mixed norms, one side at a time.
#include "verify/superquadric.hpp"

#include <cmath>
#include <utility>

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

/// A bound of (x^p + y^p)^(1/p) for nonnegative x and y. The larger operand is factored out: every power has a base in
/// [0, 1] or [1, 2], nothing overflows, and the small term's large relative error does no harm.
template <class T>
T norm(const T& x, const T& y, const NormExponent<T>& p, Direction direction) {
  const T& large = x < y ? y : x;
  const T& small = x < y ? x : y;
  if (p.infinite || small == T(0) || large == T(std::numeric_limits<double>::infinity())) return large;
  const bool up = direction == Direction::up;
  // Falls with p because ratio <= 1 (a quotient below 1 rounds to at most 1).
  const T ratio = divide(small, large, direction);
  const T term = power(ratio, up ? p.value.lower() : p.value.upper(), direction);
  // Rises with 1/p because the base is at least 1.
  const T sum = add(T(1), term, direction);
  const T root = power(sum, up ? p.reciprocal.upper() : p.reciprocal.lower(), direction);
  return multiply(large, root, direction);
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
T SuperquadricBounds<T>::gauge(const std::array<T, 3>& coordinates, Direction direction) const {
  const T x = divide(coordinates[0], semi_axes_[0], direction);
  const T y = divide(coordinates[1], semi_axes_[1], direction);
  const T z = divide(coordinates[2], semi_axes_[2], direction);
  return norm(norm(x, y, inner_, direction), z, outer_, direction);
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
