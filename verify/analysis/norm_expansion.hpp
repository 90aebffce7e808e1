/// Value, gradient and Hessian of a superquadric's support function and of its gauge, in closed form, for
/// floating-point numbers and for intervals.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include "verify/numbers/vector.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

template <class Number>
inline constexpr bool is_interval = std::is_same_v<Number, PreciseInterval>;

/// The gradient of the support function is the support point, its Hessian how that moves with the direction. The
/// gradient of the gauge is an outer normal.
template <class Number>
struct NormExpansion {
  using Vector = std::conditional_t<is_interval<Number>, PreciseVector, Eigen::Matrix<Number, 3, 1>>;
  using Matrix = std::conditional_t<is_interval<Number>, PreciseMatrix, Eigen::Matrix<Number, 3, 3>>;

  Number value;
  Vector gradient;
  Matrix hessian;
};

/// ‖(x, y)‖_q with all derivatives up to the second.
template <class Number>
struct PlanarNorm {
  Number value;
  Number dx, dy;
  Number dxx, dxy, dyy;
};

/// Precondition: large > 0, small >= 0; k = q - 1. With t = small / large and N the norm,
///     N = large (1 + t^q)^(1/q),   dN/dlarge = (large / N)^k = (N / large) / (1 + t^q),   dN/dsmall = t^k dN/dlarge.
/// These identities hold in either order of the two: "large" only avoids overflow.
template <class Number>
[[nodiscard]] PlanarNorm<Number> planar_norm(const Number& large, const Number& small, const Number& k) {
  using std::pow;
  const Number one(1);
  const Number t = small / large;
  const Number t_k = pow(t, k);
  // t^(k - 1) is infinite at t = 0 for k < 1.
  const Number curvature = is_interval<Number> ? Number(pow(t, Number(k - one))) : Number(t_k / t);
  const Number sum = one + t * t_k;
  const Number ratio = pow(sum, Number(one / (k + one)));
  PlanarNorm<Number> n;
  n.value = large * ratio;
  n.dx = ratio / sum;
  n.dy = t_k * n.dx;
  const Number scale = k * n.dx / n.value;
  n.dxx = scale * ratio * t * t_k / sum;
  n.dxy = -(scale * n.dy);
  n.dyy = scale * ratio * curvature / sum;
  return n;
}

template <class Number>
[[nodiscard]] bool comes_before(const Number& x, const Number& y) {
  if constexpr (is_interval<Number>) {
    return x.upper() < y.upper();
  } else {
    return x < y;
  }
}

template <class Number>
[[nodiscard]] PlanarNorm<Number> ordered_planar_norm(const Number& x, const Number& y, const Number& k) {
  if (!comes_before(x, y)) return planar_norm<Number>(x, y, k);
  const PlanarNorm<Number> n = planar_norm<Number>(y, x, k);
  return {n.value, n.dy, n.dx, n.dyy, n.dxy, n.dxx};
}

/// -1, 0, 1; of an interval their hull.
template <class Number>
[[nodiscard]] Number sign_of(const Number& x) {
  if constexpr (is_interval<Number>) {
    const auto sign = [](const Real& a) { return Real(a > Real(0) ? 1 : a < Real(0) ? -1 : 0); };
    return Number(sign(x.lower()), sign(x.upper()));
  } else {
    return Number(x > 0 ? 1 : x < 0 ? -1 : 0);
  }
}

/// ‖( ‖(w1 v1, w2 v2)‖_q2 , w3 v3 )‖_q1 and its derivatives: the support function has the semi-axes as weights, the
/// gauge their reciprocals (docs/mathematics.md §1). Over a box the intervals contain the values of all its points;
/// they are unbounded, or std::domain_error is thrown, where a component with q < 2 may vanish, or two components at
/// once. Floating-point results are proposals: exponents are kept away from 0 and 2, where the solid has edges or flat
/// faces, and zero components are replaced by tiny ones in the Hessian.
template <class Number>
class NormFunction {
 public:
  using Vector = typename NormExpansion<Number>::Vector;

  /// h, with q - 1 = e / (2 - e). For intervals: precondition that both exponents are below 2.
  [[nodiscard]] static NormFunction support(const Superquadric& solid) {
    NormFunction h;
    for (std::size_t i = 0; i < 3; ++i) h.weights_[i] = exact(solid.semi_axes[i]);
    const auto excess = [](const Number& e) { return Number(e / (Number(2) - e)); };
    h.outer_ = excess(resolved(solid.exponents[0]));
    h.inner_ = excess(resolved(solid.exponents[1]));
    return h;
  }

  /// g, with p - 1 = (2 - e) / e.
  [[nodiscard]] static NormFunction gauge(const Superquadric& solid) {
    NormFunction g;
    for (std::size_t i = 0; i < 3; ++i) g.weights_[i] = Number(1) / exact(solid.semi_axes[i]);
    const auto excess = [](const Number& e) { return Number((Number(2) - e) / e); };
    g.outer_ = excess(resolved(solid.exponents[0]));
    g.inner_ = excess(resolved(solid.exponents[1]));
    return g;
  }

  /// Precondition: v is not zero.
  [[nodiscard]] NormExpansion<Number> operator()(const Vector& v) const {
    const std::array<Number, 3> w = magnitudes_of(v);
    const PlanarNorm<Number> section = ordered_planar_norm<Number>(w[0], w[1], inner_);
    const PlanarNorm<Number> whole = ordered_planar_norm<Number>(section.value, w[2], outer_);
    std::array<Number, 3> signed_weights;
    for (std::size_t i = 0; i < 3; ++i) signed_weights[i] = weights_[i] * sign_of<Number>(v[static_cast<int>(i)]);
    NormExpansion<Number> result;
    result.value = whole.value;
    result.gradient = {signed_weights[0] * whole.dx * section.dx, signed_weights[1] * whole.dx * section.dy,
                       signed_weights[2] * whole.dy};
    const auto product = [&](std::size_t i, std::size_t j) { return Number(signed_weights[i] * signed_weights[j]); };
    const auto own = [&](std::size_t i) { return Number(weights_[i] * weights_[i]); };
    auto& m = result.hessian;
    m(0, 0) = own(0) * (whole.dxx * section.dx * section.dx + whole.dx * section.dxx);
    m(1, 1) = own(1) * (whole.dxx * section.dy * section.dy + whole.dx * section.dyy);
    m(2, 2) = own(2) * whole.dyy;
    m(0, 1) = product(0, 1) * (whole.dxx * section.dx * section.dy + whole.dx * section.dxy);
    m(0, 2) = product(0, 2) * whole.dxy * section.dx;
    m(1, 2) = product(1, 2) * whole.dxy * section.dy;
    m(1, 0) = m(0, 1);
    m(2, 0) = m(0, 2);
    m(2, 1) = m(1, 2);
    return result;
  }

 private:
  NormFunction() = default;

  [[nodiscard]] static Number exact(double x) {
    if constexpr (is_interval<Number>) {
      return Number(Real(x));
    } else {
      return Number(x);
    }
  }

  [[nodiscard]] static Number resolved(double e) {
    if constexpr (is_interval<Number>) {
      return exact(e);
    } else {
      // As near to 2 as the digits of t^(e / (2 - e)) allow.
      constexpr double largest = std::is_floating_point_v<Number> ? 2.0 - 1e-7 : 2.0 - 0x1p-52;
      return exact(std::clamp(e, 1e-9, largest));
    }
  }

  [[nodiscard]] std::array<Number, 3> magnitudes_of(const Vector& v) const {
    using std::abs;
    std::array<Number, 3> w;
    for (std::size_t i = 0; i < 3; ++i) w[i] = weights_[i] * abs(v[static_cast<int>(i)]);
    if constexpr (!is_interval<Number>) {
      const Number least = std::max({w[0], w[1], w[2]}) * Number(1e-100);
      for (Number& x : w) x = std::max(x, least);
    }
    return w;
  }

  std::array<Number, 3> weights_;
  Number outer_, inner_;
};

}  // namespace verisq::verify
