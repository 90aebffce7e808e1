/// Norms of a superquadric's sections, their support functions and expansions.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <boost/multiprecision/eigen.hpp>
#include <boost/multiprecision/mpfr.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <type_traits>

#include "verify/numbers/interval.hpp"
#include "verify/numbers/real.hpp"
#include "verify/numbers/vector.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// Floating point of 50 decimal digits for proposals, exchanged exactly or to nearest with the numbers of proofs.

using FiftyDigits =
    boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<50, boost::multiprecision::allocate_stack>,
                                  boost::multiprecision::et_off>;

/// Boost 1.74 makes each value of numeric_limits at its first call, without a lock: a second thread could read 0. The
/// first calls (Eigen makes them, too) are made here, before any thread starts.
inline const std::array limits_made_before_threads{
    std::numeric_limits<FiftyDigits>::infinity(), std::numeric_limits<FiftyDigits>::epsilon(),
    (std::numeric_limits<FiftyDigits>::min)(), (std::numeric_limits<FiftyDigits>::max)()};

/// Rounds to nearest.
[[nodiscard]] inline Real to_real(const FiftyDigits& x) {
  Real result;
  mpfr_set(result.get(), x.backend().data(), MPFR_RNDN);
  return result;
}

/// Exact.
[[nodiscard]] inline FiftyDigits to_fifty_digits(const Real& x) {
  FiftyDigits result;
  mpfr_set(result.backend().data(), x.get(), MPFR_RNDN);
  return result;
}

// The norm of two numbers with its derivatives, for floating-point numbers and for intervals.

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
/// These identities hold in either order of the two numbers: "large" only avoids overflow.
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

// The root that a taper makes the support function of: of ‖(r, Z + k τ)‖_q = τ, in floating point and enclosed.

/// With r the norm of a direction's section, Z = a3 v_z and the excess q - 1 of the outer norm (docs/mathematics.md
/// §18). f(τ) = ‖(r, Z + k τ)‖ - τ is convex and falls, with a slope between -1 - |k| and -1 + |k|.
template <class Number>
struct RootEquation {
  Number section;
  Number height;
  Number k;
  Number excess;

  [[nodiscard]] Number moved(const Number& root) const { return height + k * root; }

  /// ‖(r, |Z + k τ|)‖; `dy` is its derivative by the second.
  [[nodiscard]] PlanarNorm<Number> norm(const Number& root) const {
    using std::abs;
    return ordered_planar_norm<Number>(section, Number(abs(moved(root))), excess);
  }
};

/// The root by Newton's method, which ascends from a start where f is not negative. Precondition: section > 0.
template <class Float>
[[nodiscard]] Float root_of(const RootEquation<Float>& equation) {
  const auto& [section, height, k, excess] = equation;
  Float root = std::max({section, Float(height / (1 - k)), Float(-height / (1 + k))});
  for (int i = 0; i < 100; ++i) {
    const PlanarNorm<Float> norm = equation.norm(root);
    const Float slope = (equation.moved(root) < 0 ? Float(-k) : k) * norm.dy - 1;
    const Float step = (root - norm.value) / slope;
    root += step;
    if (!(step > 4 * std::numeric_limits<Float>::epsilon() * root)) break;
  }
  return root;
}

/// The roots for all numbers of the intervals, found about one of them, τ, by f(τ) and f's slopes (mean value theorem).
/// First all possible slopes serve, then only those between τ and the roots that the first step leaves. Throws
/// std::domain_error if section may be 0.
[[nodiscard]] inline PreciseInterval root_of(const RootEquation<PreciseInterval>& equation) {
  const auto middle = [](const PreciseInterval& x) {
    return FiftyDigits((to_fifty_digits(x.lower()) + to_fifty_digits(x.upper())) / 2);
  };
  if (!(equation.section.lower() > Real(0))) throw std::domain_error("support function: a section may vanish");
  const PreciseInterval root(to_real(root_of<FiftyDigits>(
      {middle(equation.section), middle(equation.height), middle(equation.k), middle(equation.excess)})));
  const PreciseInterval one(1);
  const PreciseInterval f = equation.norm(root).value - root;
  const PreciseInterval most = abs(equation.k);
  const PreciseInterval any_slope = hull(one - most, one + most);  // but for the sign
  const PreciseInterval near_root = hull(root, root + f / any_slope);
  const PreciseInterval moved = equation.moved(near_root);
  const PreciseInterval dy = equation.norm(near_root).dy;
  const PreciseInterval share(std::max(Real(0), dy.lower()), std::min(Real(1), dy.upper()));
  const PreciseInterval slope = one - equation.k * sign_of<PreciseInterval>(moved) * share;
  const PreciseInterval found = root + f / slope;
  return {std::max(found.lower(), near_root.lower()), std::min(found.upper(), near_root.upper())};
}

// Value, gradient and Hessian of a superquadric's support function and of its gauge, in closed form, for
// floating-point numbers and for intervals.

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

/// ‖( ‖(w1 v1, w2 v2)‖_q2 , w3 v3 )‖_q1 and its derivatives: the support function has the semi-axes as weights, the
/// gauge their reciprocals (docs/mathematics.md §1). §18 gives the effect of a taper on both; with a taper, v is a
/// vector of the frame whose origin is the focus. Over a box the intervals contain the values of all its points. They
/// are unbounded, or std::domain_error is thrown, if a component with q < 2 may vanish, or two components at once.
/// Floating-point results are proposals: exponents are kept away from 0 and 2, where the solid has edges or flat faces,
/// and tiny numbers replace zero components in the Hessian.
template <class Number>
class NormFunction {
 public:
  using Vector = typename NormExpansion<Number>::Vector;

  /// h, with q - 1 = e / (2 - e). For intervals: precondition that both exponents are below 2.
  [[nodiscard]] static NormFunction support(const Superquadric& solid) {
    NormFunction h(solid, Kind::support);
    for (std::size_t i = 0; i < 3; ++i) h.weights_[i] = exact(solid.semi_axes[i]);
    const auto excess = [](const Number& e) { return Number(e / (Number(2) - e)); };
    h.outer_ = excess(resolved(solid.exponents[0]));
    h.inner_ = excess(resolved(solid.exponents[1]));
    return h;
  }

  /// h(-v), the support function of the solid reflected at the origin of its frame: of -K, with k for -k.
  [[nodiscard]] static NormFunction support_of_reflected(const Superquadric& solid) {
    NormFunction h = support(solid);
    h.k_ = -h.k_;
    h.tilt_ = -h.tilt_;
    return h;
  }

  /// g, with p - 1 = (2 - e) / e.
  [[nodiscard]] static NormFunction gauge(const Superquadric& solid) {
    NormFunction g(solid, Kind::gauge);
    for (std::size_t i = 0; i < 3; ++i) g.weights_[i] = Number(1) / exact(solid.semi_axes[i]);
    const auto excess = [](const Number& e) { return Number((Number(2) - e) / e); };
    g.outer_ = excess(resolved(solid.exponents[0]));
    g.inner_ = excess(resolved(solid.exponents[1]));
    return g;
  }

  /// Precondition: v is not zero.
  [[nodiscard]] NormExpansion<Number> operator()(const Vector& v) const {
    if (!tapered_) return norm(v);
    return kind_ == Kind::support ? tapered_support(v) : tapered_gauge(v);
  }

 private:
  enum class Kind : std::uint8_t { support, gauge };
  using Matrix = typename NormExpansion<Number>::Matrix;

  NormFunction(const Superquadric& solid, Kind kind)
      : kind_(kind),
        tapered_(is_tapered(solid)),
        k_(Number((exact(solid.taper) - Number(1)) / (exact(solid.taper) + Number(1)))),
        tilt_(Number(k_ / exact(solid.semi_axes[2]))),
        fall_(Number(Number(1) - k_ * k_)) {}

  /// Without the taper.
  [[nodiscard]] NormExpansion<Number> norm(const Vector& v) const {
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

  /// (N(v) - (k/a3) v_z) / (1 - k²)
  [[nodiscard]] NormExpansion<Number> tapered_gauge(const Vector& v) const {
    NormExpansion<Number> g = norm(v);
    g.value = Number((g.value - tilt_ * v[2]) / fall_);
    g.gradient[2] = Number(g.gradient[2] - tilt_);
    g.gradient = Vector(g.gradient / fall_);
    g.hessian = Matrix(g.hessian * Number(Number(1) / fall_));
    return g;
  }

  /// (1 - k²) τ(v) with M(u) = τ, u = v + (0, 0, k τ/a3). With D = 1 - (k/a3) ∂M/∂u_z, the gradient p of τ is the
  /// gradient of M divided by D, and du = J dv with J = I + (k/a3) e3 p^T. The Hessian of τ is J^T D²M J / D.
  [[nodiscard]] NormExpansion<Number> tapered_support(const Vector& v) const {
    const Number root = root_at(v);
    Vector u = v;
    u[2] = Number(v[2] + tilt_ * root);
    const NormExpansion<Number> m = norm(u);
    const Number fall_along_root(Number(1) - tilt_ * m.gradient[2]);
    const Vector p = m.gradient / fall_along_root;
    Matrix j;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column)
        j(row, column) = Number(Number(row == column ? 1 : 0) + (row == 2 ? Number(tilt_ * p[column]) : Number(0)));
    }
    const Matrix curvature = j.transpose() * m.hessian * j;
    return {Number(fall_ * root), Vector(p * fall_), Matrix(curvature * Number(fall_ / fall_along_root))};
  }

  [[nodiscard]] Number root_at(const Vector& v) const {
    const std::array<Number, 3> w = magnitudes_of(v);
    return root_of(RootEquation<Number>{ordered_planar_norm<Number>(w[0], w[1], inner_).value,
                                        Number(weights_[2] * v[2]), k_, outer_});
  }

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
      // The largest value below 2 for which t^(e / (2 - e)) still has enough digits.
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

  Kind kind_;
  bool tapered_;
  Number k_;     ///< the taper's k
  Number tilt_;  ///< k / a3
  Number fall_;  ///< 1 - k²
  std::array<Number, 3> weights_;
  Number outer_, inner_;
};

}  // namespace verisq::verify
