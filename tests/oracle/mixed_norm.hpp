/// A superquadric as the unit ball of a mixed norm (docs/mathematics.md §1): gauge, its gradient and the support
/// function, for double (to propose) and Real (to prove).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <verisq/model.hpp>

#include "tests/oracle/real.hpp"

namespace verisq::oracle {

/// The exponents of one norm and of its dual. An exponent e = 2 is the pair (1, infinity), kept as a flag.
template <class Number>
struct ConjugateExponents {
  Number primal;            ///< p = 2/e
  Number primal_minus_one;  ///< (2 - e)/e without cancellation
  Number dual;              ///< q = 2/(2 - e); unused when `dual_is_maximum`
  bool dual_is_maximum;

  explicit ConjugateExponents(double e)
      : primal(Number(2) / Number(e)),
        primal_minus_one((Number(2) - Number(e)) / Number(e)),
        dual(e == 2.0 ? Number(0) : Number(2) / (Number(2) - Number(e))),
        dual_is_maximum(e == 2.0) {}
};

/// ‖(a, b)‖ with exponent p for a, b >= 0, the larger of the two factored out.
template <class Number>
[[nodiscard]] Number planar_norm(const Number& a, const Number& b, const Number& p) {
  using std::pow;
  const Number& large = std::max(a, b);
  const Number& small = std::min(a, b);
  if (small == 0) return large;
  return large * pow(1 + pow(small / large, p), 1 / p);
}

template <class Number>
class MixedNorm {
 public:
  explicit MixedNorm(const Superquadric& s)
      : axes_{Number(s.semi_axes[0]), Number(s.semi_axes[1]), Number(s.semi_axes[2])},
        outer_(s.exponents[0]),
        inner_(s.exponents[1]) {}

  [[nodiscard]] const Triple<Number>& semi_axes() const { return axes_; }
  [[nodiscard]] const ConjugateExponents<Number>& outer() const { return outer_; }  ///< of e1
  [[nodiscard]] const ConjugateExponents<Number>& inner() const { return inner_; }  ///< of e2

  /// g(x): the solid is g <= 1.
  [[nodiscard]] Number gauge(const Triple<Number>& x) const {
    using std::abs;
    const auto section = planar_norm<Number>(abs(x[0]) / axes_[0], abs(x[1]) / axes_[1], inner_.primal);
    return planar_norm<Number>(section, abs(x[2]) / axes_[2], outer_.primal);
  }

  /// h(v): the largest v·x over the solid.
  [[nodiscard]] Number support(const Triple<Number>& v) const {
    using std::abs;
    const Number section = dual_norm(abs(v[0]) * axes_[0], abs(v[1]) * axes_[1], inner_);
    return dual_norm(section, abs(v[2]) * axes_[2], outer_);
  }

  /// Gradient of g at x != 0 in the positive octant; at a corner of the solid, one of the subgradients.
  /// `gauge` is g(x). The gradient n has h(n) = 1 and n·x = g(x).
  [[nodiscard]] Triple<Number> gradient(const Triple<Number>& x, const Number& gauge) const {
    using std::pow;
    const Triple<Number> X{x[0] / axes_[0], x[1] / axes_[1], x[2] / axes_[2]};
    const auto section = planar_norm<Number>(X[0], X[1], inner_.primal);
    Triple<Number> n{Number(0), Number(0), pow(X[2] / gauge, outer_.primal_minus_one) / axes_[2]};
    if (section == 0) return n;
    const Number radial = pow(section / gauge, outer_.primal_minus_one);
    for (std::size_t i = 0; i < 2; ++i) n[i] = radial * pow(X[i] / section, inner_.primal_minus_one) / axes_[i];
    return n;
  }

 private:
  static Number dual_norm(const Number& a, const Number& b, const ConjugateExponents<Number>& exponents) {
    return exponents.dual_is_maximum ? std::max(a, b) : planar_norm<Number>(a, b, exponents.dual);
  }

  Triple<Number> axes_;
  ConjugateExponents<Number> outer_;
  ConjugateExponents<Number> inner_;
};

}  // namespace verisq::oracle
