/// Mixed norms, one side at a time: what SuperquadricBounds are made of, for the two types of their numbers.
#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "verify/proof/proposals.hpp"
#include "verify/proof/superquadric.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

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

/// base^exponent for 0 <= base, on one side; each of the two types has its own.
[[nodiscard]] double bound_of_power(double base, double exponent, Direction direction);
[[nodiscard]] Real bound_of_power(const Real& base, const Real& exponent, Direction direction);

/// An e with x < 2^e, for x > 0.
[[nodiscard]] inline double binary_exponent(double x) {
  return std::ilogb(x) + 1.0;
}

[[nodiscard]] inline double binary_exponent(const Real& x) {
  return static_cast<double>(mpfr_get_exp(x.get()));
}

[[nodiscard]] inline long double nearest(double x) {
  return x;
}

[[nodiscard]] inline long double nearest(const Real& x) {
  return x.to_long_double();
}

/// Whether ratio^p is proven to be too small to change 1 but for one rounding, for 0 <= ratio <= 1 and p >= 1.
template <class T>
bool is_negligible(const T& ratio, const NormExponent<T>& p) {
  // Four bits and more beyond the precision: the rounding of this product and of p does not matter.
  constexpr long double limit = std::is_same_v<T, double> ? -58.0 : -132.0;
  return ratio == T(0) || binary_exponent(ratio) * nearest(p.value.lower()) < limit;
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
T norm_of_two(const T& x, const T& y, const NormExponent<T>& p, Direction direction) {
  const T& large = x < y ? y : x;
  const T& small = x < y ? x : y;
  if (p.infinite || small == T(0) || large == T(infinity)) return large;
  // A quotient below 1 rounds to at most 1.
  return multiply(large, norm_of_ratio<T>(divide(small, large, direction), p, direction), direction);
}

template <class T>
SuperquadricBounds<T>::SuperquadricBounds(const Superquadric& superquadric)
    : semi_axes_{T(superquadric.semi_axes[0]), T(superquadric.semi_axes[1]), T(superquadric.semi_axes[2])},
      inner_(primal_exponent<T>(superquadric.exponents[1])),
      outer_(primal_exponent<T>(superquadric.exponents[0])),
      dual_inner_(dual_exponent<T>(superquadric.exponents[1])),
      dual_outer_(dual_exponent<T>(superquadric.exponents[0])),
      tapered_(verisq::is_tapered(superquadric)),
      taper_(superquadric.taper) {}

template <class T>
T SuperquadricBounds<T>::section(const T& x, const T& y, Direction direction) const {
  return norm_of_two(divide(x, semi_axes_[0], direction), divide(y, semi_axes_[1], direction), inner_, direction);
}

template <class T>
T SuperquadricBounds<T>::norm(const T& section, const T& z, Direction direction) const {
  return norm_of_two(section, divide(z, semi_axes_[2], direction), outer_, direction);
}

template <class T>
T SuperquadricBounds<T>::norm(const std::array<T, 3>& coordinates, Direction direction) const {
  return norm(section(coordinates[0], coordinates[1], direction), coordinates[2], direction);
}

template <class T>
T SuperquadricBounds<T>::dual_norm(const std::array<T, 3>& coordinates, Direction direction) const {
  const T x = multiply(coordinates[0], semi_axes_[0], direction);
  const T y = multiply(coordinates[1], semi_axes_[1], direction);
  const T z = multiply(coordinates[2], semi_axes_[2], direction);
  return norm_of_two(norm_of_two(x, y, dual_inner_, direction), z, dual_outer_, direction);
}

template <class T>
BasicInterval<T> SuperquadricBounds<T>::tapered_gauge(const T& norm, const BasicInterval<T>& z) const {
  return (BasicInterval<T>(norm) - taper_.k * z / BasicInterval<T>(semi_axes_[2])) / taper_.fall;
}

// g is not below 0.
template <class T>
T SuperquadricBounds<T>::gauge_down(const Vector3<T>& x) const {
  const T least = norm(magnitudes<T>(x, Direction::down), Direction::down);
  return tapered_ ? std::max(T(0), tapered_gauge(least, x[2]).lower()) : least;
}

// g is convex in z: largest at an end.
template <class T>
T SuperquadricBounds<T>::gauge_up(const Vector3<T>& x) const {
  const std::array<T, 3> largest = magnitudes<T>(x, Direction::up);
  if (!tapered_) return norm(largest, Direction::up);
  const T of_section = section(largest[0], largest[1], Direction::up);
  const auto at = [&](const T& z) {
    const T magnitude = z < T(0) ? -z : z;
    return tapered_gauge(norm(of_section, magnitude, Direction::up), z).upper();
  };
  return x[2].lower() == x[2].upper() ? at(x[2].upper()) : std::max(at(x[2].lower()), at(x[2].upper()));
}

template <class T>
T SuperquadricBounds<T>::support(const Vector3<T>& v, Direction direction) const {
  const std::array<T, 3> sizes = magnitudes<T>(v, direction);
  if (!tapered_) return dual_norm(sizes, direction);
  const T of_section = norm_of_two(multiply(sizes[0], semi_axes_[0], direction),
                                   multiply(sizes[1], semi_axes_[1], direction), dual_inner_, direction);
  return tapered_support(of_section, v[2] * BasicInterval<T>(semi_axes_[2]), direction);
}

// With r the norm of the section and Z = a3 v_z, f(τ) = ‖(r, Z + k τ)‖ - τ falls, by at least 1 - |k| and at most
// 1 + |k| times what τ rises by, because a norm of two numbers changes by no more than one of them does. So whatever τ
// is, the root is at most τ + max(0, f) / (1 - |k|) and at least τ - max(0, -f) / (1 - |k|).
template <class T>
T SuperquadricBounds<T>::tapered_support(const T& section, const BasicInterval<T>& z, Direction direction) const {
  // What the root is off is lost once.
  const long double exponent = dual_outer_.infinite ? infinity : nearest(dual_outer_.value.upper());
  const long double height = (nearest(z.lower()) + nearest(z.upper())) / 2;
  const auto root =
      static_cast<T>(proposed::support_root(nearest(section), height, nearest(taper_.k.upper()), exponent));
  const BasicInterval<T> moved = abs(z + taper_.k * BasicInterval<T>(root));
  const T norm =
      norm_of_two(section, direction == Direction::down ? moved.lower() : moved.upper(), dual_outer_, direction);
  const BasicInterval<T> f = BasicInterval<T>(norm) - BasicInterval<T>(root);
  const BasicInterval<T> room = BasicInterval<T>(1) + abs(taper_.k);  // (1 - k²) / (1 - |k|)
  const BasicInterval<T> at_root = taper_.fall * BasicInterval<T>(root);
  if (direction == Direction::up) return (at_root + room * BasicInterval<T>(std::max(T(0), f.upper()))).upper();
  return (at_root + room * BasicInterval<T>(std::min(T(0), f.lower()))).lower();
}

}  // namespace verisq::verify
