/// A superquadric: its gauge, its support function, the bounds that normals and witnesses prove; and the rigid motions
/// that place it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include "verify/numbers/vector.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// Floating-point proposals from verify/proposals. Proofs need not trust them: a bad proposal, NaN too, loosens a bound;
// it cannot make it wrong.

/// A direction or point found in floating point. It need not be accurate: a poor one proves a poor bound.
using Proposal = std::array<long double, 3>;

/// A hook, unless it is empty, is called now and then; if it returns true, a proof ends with the bound proven by then.
using Hook = std::function<bool()>;

namespace proposed {

/// About the s >= 0 at which the ray q + s w leaves {g <= level}. q and w lie in the octant of nonnegative coordinates;
/// for a tapered solid z may be negative, too.
[[nodiscard]] long double exit(const Superquadric& solid, const Proposal& q, const Proposal& w, long double level);

/// About the gradient of g at x.
[[nodiscard]] Proposal gradient(const Superquadric& solid, const Proposal& x);

/// About the point of the triangle, which may be degenerate, that is closest to the origin.
[[nodiscard]] Proposal closest_to_origin(const std::array<Proposal, 3>& corners);

/// About the root τ of ‖(r, Z + k τ)‖_q = τ, with r >= 0. q, the exponent of the outer dual norm, may be infinite.
[[nodiscard]] long double support_root(long double section, long double height, long double k, long double q);

/// {e : normal·e <= offset}
struct HalfSpace {
  std::array<double, 3> normal;
  double offset;
};

/// Multipliers m >= 0, one for each half-space, for which the least of 2 N·c - |N|² - 2 Σ m offset over the corners c,
/// with N = Σ m normal, is about to be above `value`; nothing where there are none.
[[nodiscard]] std::optional<std::vector<double>> multipliers(std::span<const std::array<double, 3>> corners,
                                                             std::span<const HalfSpace> half_spaces, double value);

/// For a convex body: returns about its farthest point in a direction of any length.
using FarthestPoint = std::function<std::array<double, 3>(const std::array<double, 3>&)>;

/// The same with the least value over a convex body; `inside` is a point of the body.
[[nodiscard]] std::optional<std::vector<double>> multipliers(const FarthestPoint& body,
                                                             const std::array<double, 3>& inside,
                                                             std::span<const HalfSpace> half_spaces, double value);

}  // namespace proposed

// The superquadric as a unit ball: bounds of its gauge and of its support function (docs/mathematics.md §1, §18).

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

/// The numbers of a solid with the taper t; k = (t - 1)/(t + 1).
template <class T>
struct TaperNumbers {
  explicit TaperNumbers(double taper)
      : k((BasicInterval<T>(T(taper)) - BasicInterval<T>(1)) / (BasicInterval<T>(T(taper)) + BasicInterval<T>(1))),
        fall(BasicInterval<T>(1) - square(k)) {}

  BasicInterval<T> k;
  BasicInterval<T> fall;  ///< 1 - k²
};

/// The vector from the centre of the solid to its focus (0, 0, -k a3), which is the origin of its own frame. Without a
/// taper the focus is the centre.
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

  /// One end of these intervals. `gauge_up` is the tightest bound for boxes of any size.
  [[nodiscard]] T gauge_down(const Vector3<T>& x) const;
  [[nodiscard]] T gauge_up(const Vector3<T>& x) const;
  [[nodiscard]] T support_down(const Vector3<T>& v) const { return support(v, Direction::down); }
  [[nodiscard]] T support_up(const Vector3<T>& v) const { return support(v, Direction::up); }

  /// A bound, on the side `direction`, of N at any point whose |coordinates| are bounded on the same side by
  /// `coordinates` (nonnegative).
  [[nodiscard]] T norm(const std::array<T, 3>& coordinates, Direction direction) const;

  /// The two norms that N consists of, for points that share coordinates: the norm of (x/a1, y/a2), and the norm of
  /// that number and z/a3.
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

// Mixed norms, one side at a time: the parts of SuperquadricBounds, for the two types of their numbers.

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

/// Returns whether ratio^p is proven to be too small to change 1 but for one rounding. Precondition: 0 <= ratio <= 1, p
/// >= 1.
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

// With r the norm of the section and Z = a3 v_z, consider f(τ) = ‖(r, Z + k τ)‖ - τ. If τ rises, f falls by at least 1
// - |k| and at most 1 + |k| times as much, because a norm of two numbers changes by no more than one of them does. So
// for any τ, the root is at most τ + max(0, f) / (1 - |k|) and at least τ - max(0, -f) / (1 - |k|).
template <class T>
T SuperquadricBounds<T>::tapered_support(const T& section, const BasicInterval<T>& z, Direction direction) const {
  // The error of the root costs its own size once.
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

// Solids of revolution: their distance depends on two coordinates only.

/// A superquadric and a point in the octant of nonnegative coordinates. An axis of revolution, if there is one, becomes
/// z; it is also the axis of a taper. For a tapered solid z keeps its sign.
struct RevolvedPoint {
  Superquadric solid;
  PreciseVector q;
  bool planar;                       ///< q[1] is 0, and balls about q that lie inside do so by the section y = 0
  std::array<std::size_t, 3> order;  ///< coordinate k is coordinate order[k] of the original
};

/// Brings the axis of an ellipsoid of revolution to z; an ellipsoid's coordinates may be exchanged freely.
[[nodiscard]] inline std::array<std::size_t, 3> revolution_order(const Superquadric& solid) {
  const auto& a = solid.semi_axes;
  if (is_tapered(solid) || solid.exponents != std::array<double, 2>{1.0, 1.0} || a[0] == a[1]) return {0, 1, 2};
  if (a[1] == a[2]) return {1, 2, 0};
  if (a[0] == a[2]) return {2, 0, 1};
  return {0, 1, 2};
}

/// Why the section decides: the gauge rises with x and y through their length alone, and the length of (x + u, y + v)
/// is at most |(x, y)| + |(u, v)|, so that the ball lies inside if the disc about (|(x, y)|, 0, z) in y = 0 does.
[[nodiscard]] inline RevolvedPoint revolved(const Superquadric& solid, const PreciseVector& q) {
  RevolvedPoint result{solid, {}, false, revolution_order(solid)};
  for (std::size_t k = 0; k < 3; ++k) {
    result.solid.semi_axes[k] = solid.semi_axes[result.order[k]];
    result.q[k] = k == 2 && is_tapered(solid) ? q[k] : abs(q[result.order[k]]);
  }
  result.planar = result.solid.semi_axes[0] == result.solid.semi_axes[1] && solid.exponents[1] == 1.0;
  if (result.planar) {
    result.q[0] = sqrt(square(result.q[0]) + square(result.q[1]));
    result.q[1] = 0;
  }
  return result;
}

// Certificates (docs/mathematics.md §2): a direction proves a lower bound of the signed distance, a point an upper
// bound.

/// sd(q) >= (v·q - h(v)) / |v| for every v, because K lies in the half-space {v·x <= h(v)}; rounded down. Minus
/// infinity for a zero or non-finite v. The bound holds for every point of the box q, given in the solid's frame.
[[nodiscard]] double lower_bound(const SuperquadricBounds<Real>& solid, const PreciseVector& q, const Proposal& v);

/// sd(q) <= |q - b| for every b in K; b = x / g(x) with g(x) rounded up has g(b) <= 1 and lies beside the surface.
/// Rounded up. The centre takes the place of a zero or non-finite x.
[[nodiscard]] double upper_bound(const SuperquadricBounds<Real>& solid, const PreciseVector& q, const Proposal& x);
/// The same for an x known to lie in a box.
[[nodiscard]] double upper_bound_at(const SuperquadricBounds<Real>& solid, const PreciseVector& q,
                                    const PreciseVector& x);

/// The exact vector, for interval arithmetic. Precondition: finite.
[[nodiscard]] PreciseVector precise(const Proposal& v);

/// A floating-point point near the middle of a thin box.
[[nodiscard]] Proposal midpoint(const PreciseVector& v);

/// Returns whether every coordinate is finite and one of them is not zero.
[[nodiscard]] bool usable(const Proposal& v);

// Rigid motions in precise interval arithmetic: from the frame of a primitive to that of its model, and back.

/// x -> R x + t, enclosed.
struct RigidMotion {
  PreciseMatrix rotation;
  PreciseVector translation;

  RigidMotion(const PreciseMatrix& r, const PreciseVector& t) : rotation(r), translation(t) {}
  /// R is the rotation of the normalised quaternion, enclosed to the rounding error of 127 bits.
  explicit RigidMotion(const Pose& pose);

  /// First `inner`, then this one.
  [[nodiscard]] RigidMotion after(const RigidMotion& inner) const;
  [[nodiscard]] RigidMotion inverse() const;
  [[nodiscard]] PreciseVector operator()(const PreciseVector& x) const;

  /// R^T (x - t)
  [[nodiscard]] PreciseVector local_point(const Point& x) const;
};

/// The exact point, for interval arithmetic. Precondition: finite.
[[nodiscard]] PreciseVector precise(const Point& x);

// The distance of two points, rounded up.

/// |x - y|, rounded up to binary64.
[[nodiscard]] inline double distance_up(const Point& x, const Point& y) {
  return length<Real>(PreciseVector(precise(x) - precise(y))).upper().to_double(Direction::up);
}

}  // namespace verisq::verify
