/// The equations of a nearest boundary point in logarithms (docs/mathematics.md §3), and Newton's method on them at 200
/// bits.
#pragma once

#include <array>
#include <optional>

#include "tests/oracle/mixed_norm.hpp"

namespace verisq::oracle {

/// Where the query point lies: outside x + λ∇g(x) = q, inside q + λ∇g(x) = x, with λ > 0 in both.
enum class Side { outside, inside };

/// A boundary point of the positive octant and its multiplier, as logarithms. Coordinates that are not `present` are
/// zero. With X = x/a1, Y = y/a2, Z = z/a3 and r = ‖(X, Y)‖ the boundary is ‖(r, Z)‖ = 1.
struct Contact {
  std::array<bool, 3> present;
  std::array<Real, 2> share;  ///< ln(X/r), ln(Y/r)
  Real radius;                ///< ln r
  Real height;                ///< ln Z
  Real multiplier;            ///< ln λ
};

/// Stationarity of one query point q >= 0. Where e = 2 the exponent p - 1 = 0 is replaced by 2^-250: that moves the
/// boundary by less than one part in 2^249, which the certificate, evaluated with the exact exponents, absorbs.
class Stationarity {
 public:
  Stationarity(const MixedNorm<Real>& norm, const Vector& q, Side side);

  /// The contact at the boundary point x / g(x); the multiplier by least squares.
  /// Precondition: x >= 0, not all zero, and x_i > 0 wherever `present`.
  [[nodiscard]] Contact contact_at(const Vector& x, const std::array<bool, 3>& present) const;

  /// The contact at the angles tau = ln(Z/r), sigma = ln(Y/X); both may be +-2^250.
  [[nodiscard]] Contact contact_at(const Real& tau, const Real& sigma, const std::array<bool, 3>& present) const;

  /// Newton from `contact` until the largest residual is below `tolerance` before a step; empty when it does not get
  /// there.
  [[nodiscard]] std::optional<Contact> solve(Contact contact, const Real& tolerance) const;

  [[nodiscard]] Vector point(const Contact& contact) const;

  /// The p - 1 that the equations use for e1 and e2.
  [[nodiscard]] const Real& outer_slope() const { return outer_slope_; }
  [[nodiscard]] const Real& inner_slope() const { return inner_slope_; }

 private:
  struct Equation;
  struct Row;
  [[nodiscard]] Equation linearised(std::size_t axis, const Contact& contact) const;
  [[nodiscard]] Real least_squares_multiplier(const Contact& contact) const;
  [[nodiscard]] static Real pivot_of(const Equation& equation, const Real& slope);
  [[nodiscard]] Row section_row(const Contact& contact, const std::array<Equation, 3>& equations) const;
  [[nodiscard]] Row boundary_row(const Contact& contact, const Equation& vertical) const;
  [[nodiscard]] Real newton_step(Contact& contact) const;

  const MixedNorm<Real>& norm_;
  Vector q_;
  Vector log_q_;
  Vector log_axes_;
  Side side_;
  Real outer_slope_;
  Real inner_slope_;
};

/// Smallest p - 1 that proposals work with, see Stationarity.
template <class Number>
[[nodiscard]] Number regularised(const Number& primal_minus_one) {
  using std::ldexp;
  return std::max(primal_minus_one, Number(ldexp(Number(1), -250)));
}

/// ln(e^a + e^b) and the share of e^a in the sum.
template <class Number>
struct LogSum {
  Number value;
  Number share_of_first;
  Number share_of_second;

  LogSum(const Number& a, const Number& b) {
    using std::exp;
    using std::log1p;
    const bool first = a >= b;
    const Number ratio = exp(first ? b - a : a - b);
    value = (first ? a : b) + log1p(ratio);
    const Number larger = 1 / (1 + ratio);
    share_of_first = first ? larger : ratio * larger;
    share_of_second = first ? ratio * larger : larger;
  }
};

}  // namespace verisq::oracle
