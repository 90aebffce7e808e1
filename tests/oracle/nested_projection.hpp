/// Closest point of a convex superquadric to a point outside by two nested monotone root searches: slow, but it cannot
/// fail to converge. In double it starts Newton's method, at 200 bits it takes over where Newton fails.
///
/// The boundary in the positive octant is parametrised by tau = ln(Z/r) and sigma = ln(Y/X), with X = x/a1, Y = y/a2,
/// Z = z/a3, r = ‖(X, Y)‖. With the forces f_i = a_i (q_i - x_i) stationarity reads f_y/f_x = (Y/X)^(p2-1) and
/// f_z/f_r = (Z/r)^(p1-1), f_r being the dual norm of (f_x, f_y). The logarithm of either equation decreases strictly
/// in its parameter, because the problem is convex.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/oracle/mixed_norm.hpp"
#include "tests/oracle/stationarity.hpp"

namespace verisq::oracle {

template <class Number>
struct ValueAndSlope {
  Number value;
  Number slope;
};

/// Sign of an equation that has no finite value because a force is not positive.
template <class Number>
[[nodiscard]] ValueAndSlope<Number> infinite(int sign) {
  const Number unbounded = std::numeric_limits<Number>::infinity();
  return {sign > 0 ? unbounded : -unbounded, Number(0)};
}

/// A point strictly between, halving the exponent where the ends differ by orders of magnitude.
template <class Number>
[[nodiscard]] Number between(const Number& low, const Number& high) {
  using std::sqrt;
  if (low > 0 && high > 4 * low) return sqrt(low) * sqrt(high);
  if (high < 0 && low < 4 * high) return -sqrt(-low) * sqrt(-high);
  if (low < -4 && high > 4) return Number(0);
  if (low <= 0 && high > 64) return Number(8);
  if (high >= 0 && low < -64) return Number(-8);
  return (low + high) / 2;
}

/// Root of a decreasing function by Newton's method inside a bracket that starts unbounded.
/// Stops when a step is below `tolerance` times max(|root|, 1/64).
template <class Number, class Function>
[[nodiscard]] Number decreasing_root(const Function& function, Number root, const Number& tolerance) {
  using std::abs;
  const Number unbounded = std::numeric_limits<Number>::infinity();
  Number low = -unbounded;
  Number high = unbounded;
  Number reach = 1 + abs(root);
  Number last = unbounded;
  for (int evaluation = 0; evaluation < 400; ++evaluation) {
    const ValueAndSlope<Number> at = function(root);
    if (at.value == 0) break;
    (at.value > 0 ? low : high) = root;
    Number next = root - at.value / at.slope;
    const bool shrinks = abs(at.value) < last / 2;
    last = abs(at.value);
    if (low == -unbounded || high == unbounded) {
      // Not bracketed yet: Newton may overshoot, but by a bounded and growing reach.
      if (!(next > low && next < high) || abs(next - root) > 16 * reach || !(abs(at.value) < unbounded)) {
        next = at.value > 0 ? Number(root + reach) : Number(root - reach);
      }
      reach *= 8;
    } else if (!(next > low && next < high) || !shrinks) {
      next = between(low, high);
    }
    const Number step = abs(next - root);
    root = next;
    if (step <= tolerance * std::max(Number(abs(root)), Number(1) / 64)) break;
  }
  return root;
}

template <class Number>
struct ContactAngles {
  Number tau;
  Number sigma;
};

template <class Number>
class NestedProjection {
 public:
  /// Precondition: g(q) > 1, q >= 0 with at least two positive coordinates; one of the first two counts.
  NestedProjection(const MixedNorm<Number>& norm, const Triple<Number>& q, const Number& tolerance)
      : norm_(norm),
        q_(q),
        tolerance_(tolerance),
        outer_slope_(regularised(norm.outer().primal_minus_one)),
        inner_slope_(regularised(norm.inner().primal_minus_one)) {}

  [[nodiscard]] ContactAngles<Number> solve() {
    using std::log;
    const Triple<Number>& a = norm_.semi_axes();
    const Number X = q_[0] / a[0];
    const Number Y = q_[1] / a[1];
    if (q_[0] > 0 && q_[1] > 0) sigma_ = log(Y / X);
    if (q_[2] == 0) {
      (void)section_force(Number(0));
      return {Number(0), sigma_};
    }
    const Number start = log(q_[2] / a[2] / planar_norm<Number>(X, Y, norm_.inner().primal));
    const auto tau = decreasing_root<Number>([this](const Number& t) { return outer_equation(t); }, start, tolerance_);
    return {tau, sigma_};
  }

 private:
  /// ln f_r and its derivative by ln r, for the section of radius r; infinite(-1) when q lies within the section.
  ValueAndSlope<Number> section_force(const Number& log_radius) {
    using std::exp;
    using std::log;
    const Triple<Number>& a = norm_.semi_axes();
    if (q_[0] == 0 || q_[1] == 0) {
      const std::size_t i = q_[0] > 0 ? 0 : 1;
      const Number x = a[i] * exp(log_radius);
      if (!(x < q_[i])) return infinite<Number>(-1);
      return {log(a[i] * (q_[i] - x)), -x / (q_[i] - x)};
    }
    const Number& p2 = norm_.inner().primal;
    if (!(exp(log_radius) < planar_norm<Number>(q_[0] / a[0], q_[1] / a[1], p2))) return infinite<Number>(-1);
    ValueAndSlope<Number> force = infinite<Number>(-1);
    const auto equation = [&](const Number& sigma) -> ValueAndSlope<Number> {
      const LogSum<Number> weights(Number(0), p2 * sigma);
      const Number log_X = log_radius - weights.value / p2;
      const Number log_Y = log_radius - LogSum<Number>(-p2 * sigma, Number(0)).value / p2;
      const Number x = a[0] * exp(log_X);
      const Number y = a[1] * exp(log_Y);
      if (!(x < q_[0])) return infinite<Number>(+1);
      if (!(y < q_[1])) return infinite<Number>(-1);
      const Number log_fx = log(a[0] * (q_[0] - x));
      const Number log_fy = log(a[1] * (q_[1] - y));
      const Number steep_x = x / (q_[0] - x);
      const Number steep_y = y / (q_[1] - y);
      const Number& part_X = weights.share_of_first;
      const Number& part_Y = weights.share_of_second;
      const Number by_sigma = -steep_y * part_X - steep_x * part_Y - inner_slope_;
      const Number sigma_by_radius = (steep_y - steep_x) / by_sigma;
      // f_r = f_x (X/r)^(1-p2) on the root; the form with the larger of X, Y keeps the precision.
      const bool first = sigma < 0;
      force.value = first ? Number(log_fx - inner_slope_ * (log_X - log_radius))
                          : Number(log_fy - inner_slope_ * (log_Y - log_radius));
      force.slope = -(part_X * steep_x + part_Y * steep_y) + part_X * part_Y * (steep_x - steep_y) * sigma_by_radius;
      return {log_fy - log_fx - inner_slope_ * sigma, by_sigma};
    };
    sigma_ = decreasing_root<Number>(equation, sigma_, tolerance_);
    return force;
  }

  ValueAndSlope<Number> outer_equation(const Number& tau) {
    using std::exp;
    using std::log;
    const Number& p1 = norm_.outer().primal;
    const LogSum<Number> weights(Number(0), p1 * tau);
    const Number log_radius = -weights.value / p1;
    const Number z = norm_.semi_axes()[2] * exp(-LogSum<Number>(-p1 * tau, Number(0)).value / p1);
    if (!(z < q_[2])) return infinite<Number>(-1);
    const ValueAndSlope<Number> radial = section_force(log_radius);
    const Number unbounded = std::numeric_limits<Number>::infinity();
    if (radial.value == -unbounded) return infinite<Number>(+1);
    const Number log_fz = log(norm_.semi_axes()[2] * (q_[2] - z));
    const Number slope =
        -z / (q_[2] - z) * weights.share_of_first + weights.share_of_second * radial.slope - outer_slope_;
    return {log_fz - radial.value - outer_slope_ * tau, slope};
  }

  const MixedNorm<Number>& norm_;
  Triple<Number> q_;
  Number tolerance_;
  Number outer_slope_;
  Number inner_slope_;
  Number sigma_ = 0;
};

}  // namespace verisq::oracle
