/// The norm of two numbers with its derivatives, for floating-point numbers and for intervals.
#pragma once

#include <cmath>
#include <type_traits>

#include "verify/numbers/interval.hpp"

namespace verisq::verify {

template <class Number>
inline constexpr bool is_interval = std::is_same_v<Number, PreciseInterval>;

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

}  // namespace verisq::verify
