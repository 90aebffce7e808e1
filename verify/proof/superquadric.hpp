/// The superquadric as a unit ball: bounds of its gauge and of its support function (docs/mathematics.md §1, §18).
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

/// k = (t - 1)/(t + 1) of docs/mathematics.md §18, to nearest.
template <class Float>
[[nodiscard]] Float taper_coefficient(double taper) {
  return (Float(taper) - 1) / (Float(taper) + 1);
}

/// What a taper t makes of the solid, k = (t - 1)/(t + 1).
template <class T>
struct TaperNumbers {
  explicit TaperNumbers(double taper)
      : k((BasicInterval<T>(T(taper)) - BasicInterval<T>(1)) / (BasicInterval<T>(T(taper)) + BasicInterval<T>(1))),
        fall(BasicInterval<T>(1) - square(k)) {}

  BasicInterval<T> k;
  BasicInterval<T> fall;  ///< 1 - k²
};

/// From the centre of the solid to its focus (0, 0, -k a3), which is the origin of its own frame: the centre itself
/// where it has no taper.
[[nodiscard]] PreciseVector focus(const Superquadric& superquadric);

/// Evaluates g and h one side at a time, in the solid's own frame. With N and its dual norm M, both of the form
///     ‖( ‖(x, y)‖_inner , z )‖_outer,
/// monotone in each |coordinate|, they are
///     g(w) = (N(w) - k w_z / a3) / (1 - k²),     h(v) = (1 - k²) τ, τ the only root of M(v + (0, 0, k τ / a3)) = τ,
/// without a taper N and M: bounds of the coordinates give bounds of the result without any overestimation beyond
/// rounding. T is double or Real.
template <class T>
class SuperquadricBounds {
 public:
  explicit SuperquadricBounds(const Superquadric& superquadric);

  /// Inclusion functions: the range of g over a box of points, of h over a box of directions, with a taper for thin
  /// boxes. The solid is {g <= 1}.
  [[nodiscard]] BasicInterval<T> gauge(const Vector3<T>& x) const { return {gauge_down(x), gauge_up(x)}; }
  [[nodiscard]] BasicInterval<T> support(const Vector3<T>& v) const { return {support_down(v), support_up(v)}; }

  /// One end of them; that of the gauge from above is the tightest for boxes of any size.
  [[nodiscard]] T gauge_down(const Vector3<T>& x) const;
  [[nodiscard]] T gauge_up(const Vector3<T>& x) const;
  [[nodiscard]] T support_down(const Vector3<T>& v) const { return support(v, Direction::down); }
  [[nodiscard]] T support_up(const Vector3<T>& v) const { return support(v, Direction::up); }

  /// A bound, on the side `direction`, of N at any point whose |coordinates| are bounded on the same side by
  /// `coordinates` (nonnegative).
  [[nodiscard]] T norm(const std::array<T, 3>& coordinates, Direction direction) const;

  /// The two norms of which N is made, for points that share coordinates: of (x/a1, y/a2), and of that with z/a3.
  [[nodiscard]] T section(const T& x, const T& y, Direction direction) const;
  [[nodiscard]] T norm(const T& section, const T& z, Direction direction) const;

  [[nodiscard]] bool is_tapered() const { return tapered_; }
  [[nodiscard]] const TaperNumbers<T>& taper() const { return taper_; }

 private:
  [[nodiscard]] T support(const Vector3<T>& v, Direction direction) const;
  [[nodiscard]] T dual_norm(const std::array<T, 3>& coordinates, Direction direction) const;
  [[nodiscard]] BasicInterval<T> tapered_gauge(const T& norm, const BasicInterval<T>& z) const;
  [[nodiscard]] T tapered_support(const T& section, const BasicInterval<T>& z, Direction direction) const;

  std::array<T, 3> semi_axes_;
  NormExponent<T> inner_, outer_;            // p2 = 2/e2, p1 = 2/e1
  NormExponent<T> dual_inner_, dual_outer_;  // q2 = 2/(2 - e2), q1 = 2/(2 - e1)
  bool tapered_;
  TaperNumbers<T> taper_;
};

extern template class SuperquadricBounds<double>;
extern template class SuperquadricBounds<Real>;

}  // namespace verisq::verify
