/// The superquadric as a unit ball: bounds of its gauge and of its support function (docs/mathematics.md §1).
#pragma once

#include <array>

#include "verify/numbers/vector.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// The exponent p of a norm and 1/p, both enclosed: they are rounded quotients of the input. `infinite` (from e = 2 in
/// the dual) makes the norm a maximum; the intervals then mean nothing.
template <class T>
struct NormExponent {
  BasicInterval<T> value;
  BasicInterval<T> reciprocal;
  bool infinite = false;
};

/// The smallest (down) or the largest (up) |coordinates| over a box.
template <class T>
[[nodiscard]] std::array<T, 3> magnitudes(const Vector3<T>& v, Direction direction) {
  const auto magnitude = [direction](const BasicInterval<T>& x) {
    const BasicInterval<T> a = abs(x);
    return direction == Direction::down ? a.lower() : a.upper();
  };
  return {magnitude(v[0]), magnitude(v[1]), magnitude(v[2])};
}

/// Evaluates g and h one side at a time. Both are norms of the form
///     ‖( ‖(x, y)‖_inner , z )‖_outer,
/// monotone in each |coordinate|: bounds of the coordinates give bounds of the result without any overestimation beyond
/// rounding. T is double or Real.
template <class T>
class SuperquadricBounds {
 public:
  explicit SuperquadricBounds(const Superquadric& superquadric);

  /// A bound, on the side `direction`, of the gauge g at any point whose |coordinates| are bounded on the same side by
  /// `coordinates` (nonnegative). The solid is {g <= 1}.
  [[nodiscard]] T gauge(const std::array<T, 3>& coordinates, Direction direction) const;

  /// The two norms of which the gauge is made, for points that share coordinates: of (x/a1, y/a2), and of that with
  /// z/a3.
  [[nodiscard]] T section(const T& x, const T& y, Direction direction) const;
  [[nodiscard]] T gauge(const T& section, const T& z, Direction direction) const;

  /// The same of the support function h(v), the largest v·x over the solid.
  [[nodiscard]] T support(const std::array<T, 3>& coordinates, Direction direction) const;

  /// Inclusion functions: the range of g over a box of points, of h over a box of directions.
  [[nodiscard]] BasicInterval<T> gauge(const Vector3<T>& x) const;
  [[nodiscard]] BasicInterval<T> support(const Vector3<T>& v) const;

 private:
  std::array<T, 3> semi_axes_;
  NormExponent<T> inner_, outer_;            // p2 = 2/e2, p1 = 2/e1
  NormExponent<T> dual_inner_, dual_outer_;  // q2 = 2/(2 - e2), q1 = 2/(2 - e1)
};

extern template class SuperquadricBounds<double>;
extern template class SuperquadricBounds<Real>;

}  // namespace verisq::verify
