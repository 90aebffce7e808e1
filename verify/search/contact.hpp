/// The point at which a superquadric is nearest to a body: the contact problem and its solution.
#pragma once

#include <algorithm>
#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tuple>

#include "verify/proposals/support_mapping.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// Proposes the certificate of a point outside: the closest point of the solid and the normal there.

/// Closest point x of the solid and a direction v along q - x.
struct Contact {
  Proposal point;
  Proposal normal;
};

/// Solves the optimality conditions x_i + λ n_i(x) = q_i, g(x) = 1 for q outside, in the solid's frame. Proves nothing;
/// for q inside or on the surface the result is the radial projection and the normal there. `rough` works in binary64
/// and takes a fraction of the time of `fast`. `fast` works in long double and is accurate to its rounding for 1e-7 < e
/// < 2 - 1e-8 and e = 2. `thorough` works in 50 digits and takes some hundred times longer.
[[nodiscard]] Contact rough_contact(const Superquadric& solid, const Proposal& q);
[[nodiscard]] Contact fast_contact(const Superquadric& solid, const Proposal& q);
[[nodiscard]] Contact thorough_contact(const Superquadric& solid, const Proposal& q);

}  // namespace verisq::verify

namespace verisq::verify::logarithmic {

// The optimality conditions of the closest point as one monotone equation in logarithms, for any floating-point type.
//
// In units of the semi-axes, X_i = x_i / a_i, the conditions of docs/mathematics.md §3 are, with k_i = p_i - 1,
//     X + (μ / a1^2) X^k2 = q1 / a1,     Y alike,     Z + (λ / a3^2) Z^k1 = q3 / a3,
//     λ = μ r^(p2 - p1),     r = ‖(X, Y)‖_p2,     g = ‖(r, Z)‖_p1 = 1.
// Given μ, each equation has one root. X and Y fall as μ rises. So does Z, because λ rises: D(r), the squared distance
// of (q1, q2) to the section ‖(X, Y)‖_p2 <= r, is convex. So its multiplier μ r^k2 rises as r falls, and λ = (μ r^k2)
// r^(-k1). Hence g falls as μ rises, and the whole problem is one monotone equation in ln μ, solved by Newton steps
// inside a bracket.

// Long double uses these; other types bring their own.
using std::copysign;
using std::exp;
using std::expm1;
using std::fabs;
using std::isfinite;
using std::log;
using std::log1p;

/// The limits that the precision of the logarithms sets.
struct Resolution {
  double surface;     ///< ln g of points closer to the surface is rounding error
  double step;        ///< the step after which Newton's method stops: the remaining error is of the order of its square
  double below_two;   ///< smallest positive 2 - e
  double above_zero;  ///< smallest e
};

template <class Float>
constexpr Resolution kResolution{};
template <>
inline constexpr Resolution kResolution<double>{.surface = 1e-14, .step = 1e-8, .below_two = 1e-8, .above_zero = 1e-6};
template <>
inline constexpr Resolution kResolution<long double>{
    .surface = 1e-16, .step = 1e-10, .below_two = 1e-10, .above_zero = 1e-7};

template <class Float>
[[nodiscard]] Float infinity_as() {
  return std::numeric_limits<Float>::infinity();
}

/// log(e^a + e^b) and the weight e^b / (e^a + e^b) of the second term.
template <class Float>
struct LogSum {
  Float value;
  Float weight;
};

template <class Float>
[[nodiscard]] LogSum<Float> log_sum(const Float& a, const Float& b) {
  if (a == -infinity_as<Float>()) return {b, Float(b == -infinity_as<Float>() ? 0 : 1)};
  if (b == -infinity_as<Float>()) return {a, Float(0)};
  const Float difference = b - a;
  const Float small = exp(-fabs(difference));
  return {std::max(a, b) + log1p(small), (difference > 0 ? Float(1) : small) / (1 + small)};
}

/// ln ‖(e^a, e^b)‖ with exponent p = k + 1.
template <class Float>
[[nodiscard]] Float log_norm(const Float& a, const Float& b, const Float& k) {
  if (std::max(a, b) == -infinity_as<Float>()) return -infinity_as<Float>();
  return log_sum<Float>(a * (k + 1), b * (k + 1)).value / (k + 1);
}

/// Root of X + e^c X^k = e^s in logarithms.
template <class Float>
struct Coordinate {
  Float log_x;        ///< ln X; minus infinity where X = 0
  Float log_weight;   ///< ln of the second term's share of e^s
  Float sensitivity;  ///< d ln X / d c, not positive
};

/// The linear case k = 0 (e = 2): X = max(0, e^s - e^c).
template <class Float>
[[nodiscard]] Coordinate<Float> solve_linear(const Float& s, const Float& c) {
  if (c >= s) return {-infinity_as<Float>(), Float(0), Float(0)};
  const Float weight = exp(c - s);
  return {s + log1p(-weight), c - s, -weight / (1 - weight)};
}

template <class Float>
[[nodiscard]] Coordinate<Float> solve_coordinate(const Float& s, const Float& c, const Float& k, double last_step) {
  if (s == -infinity_as<Float>() || c == infinity_as<Float>()) return {-infinity_as<Float>(), Float(0), Float(0)};
  if (k == 0) return solve_linear(s, c);
  // The left side is convex in ln X, and at this start it is at least the right side: Newton descends monotonically.
  Float u = std::min<Float>(s, (s - c) / k);
  LogSum<Float> sum = log_sum<Float>(u, c + k * u);
  for (int i = 0; i < 64; ++i) {
    const Float step = (sum.value - s) / ((1 - sum.weight) + k * sum.weight);
    u -= step;
    sum = log_sum<Float>(u, c + k * u);
    if (!(step > last_step * (1 + fabs(u)))) break;
  }
  const Float log_weight = -log_sum<Float>(Float(0), u - (c + k * u)).value;
  return {u, log_weight, -sum.weight / ((1 - sum.weight) + k * sum.weight)};
}

template <class Float>
class ContactProblem {
 public:
  ContactProblem(const Superquadric& solid, const Proposal& q, const Resolution& resolution)
      : resolution_(resolution), k2_(excess(solid.exponents[1])), k1_(excess(solid.exponents[0])) {
    for (std::size_t i = 0; i < 3; ++i) {
      q_[i] = static_cast<Float>(q[i]);
      a_[i] = solid.semi_axes[i];
      log_target_[i] = log(Float(fabs(q_[i]) / a_[i]));
    }
    const Float largest = *std::ranges::max_element(a_);
    for (std::size_t i = 0; i < 3; ++i) log_axis_[i] = log(Float(a_[i] / largest));
    if (q[0] == 0.0L || q[1] == 0.0L) k2_ = k1_;  // the section is a segment: its norm has any exponent
    by_radius_ = radius_is_unknown();
  }

  [[nodiscard]] Contact solve() const {
    const Float log_gauge = log_norm(log_norm(log_target_[0], log_target_[1], k2_), log_target_[2], k1_);
    if (!(log_gauge > resolution_.surface)) return radial();
    if (apex_is_closest()) return apex();
    return contact(solve_multiplier(log_gauge));
  }

 private:
  /// State at one value of the unknown m: ln μ, or -ln r for a rhombic section.
  struct Iterate {
    std::array<Coordinate<Float>, 3> coordinates;
    Float log_gauge;   ///< ln g(x): positive while m is too small
    Float derivative;  ///< d log_gauge / dm, not positive
  };

  /// p - 1 = (2 - e)/e of a nearby exponent that the logarithms resolve. Moving e by δ moves the solid by less than δ
  /// of its size, which a proposal may.
  [[nodiscard]] Float excess(double e) const {
    if (2.0 - e <= resolution_.below_two) return Float(0);
    const Float resolved = std::max(e, resolution_.above_zero);
    return (2 - resolved) / resolved;
  }

  [[nodiscard]] Coordinate<Float> coordinate(std::size_t i, const Float& log_multiplier, const Float& k) const {
    return solve_coordinate<Float>(log_target_[i], log_multiplier - 2 * log_axis_[i], k, resolution_.step);
  }

  /// ln λ - ln μ = (p2 - p1) ln r
  [[nodiscard]] Float log_ratio(const Float& log_r) const { return k1_ == k2_ ? Float(0) : Float((k2_ - k1_) * log_r); }

  /// If the section is a rhombus (e2 = 2), r may fall below the rounding error of X and Y, while λ contains a power of
  /// it: then ln r is the well-conditioned unknown. Decided at half the section radius of q itself.
  [[nodiscard]] bool radius_is_unknown() const {
    if (k2_ != 0 || k1_ == 0) return false;
    return evaluate_radius(log_norm(log_target_[0], log_target_[1], k2_) - log(Float(2))).log_gauge > 0;
  }

  [[nodiscard]] Iterate evaluate(const Float& m) const {
    return by_radius_ ? evaluate_radius(-m) : evaluate_multiplier(m);
  }

  [[nodiscard]] Iterate evaluate_multiplier(const Float& log_mu) const {
    Iterate it{};
    auto& [x, y, z] = it.coordinates;
    x = coordinate(0, log_mu, k2_);
    y = coordinate(1, log_mu, k2_);
    const LogSum<Float> section = log_sum<Float>((k2_ + 1) * x.log_x, (k2_ + 1) * y.log_x);
    const Float log_r = section.value / (k2_ + 1);
    const Float dr = (1 - section.weight) * x.sensitivity + section.weight * y.sensitivity;
    complete(it, log_r, dr, log_mu + log_ratio(log_r), 1 + (k2_ - k1_) * dr);
    return it;
  }

  /// Projects on the rhombus X + Y = r first: X = t1 - μ/a1^2, Y = t2 - μ/a2^2, or zero if that is negative.
  [[nodiscard]] Iterate evaluate_radius(const Float& log_r) const {
    Iterate it{};
    const Float r = exp(log_r);
    const std::array<Float, 2> t{exp(log_target_[0]), exp(log_target_[1])};
    const std::array<Float, 2> b{exp(Float(-2 * log_axis_[0])), exp(Float(-2 * log_axis_[1]))};
    Float sum = t[0] + t[1];
    Float mu = (sum - r) / (b[0] + b[1]);
    const std::size_t first_to_vanish = t[0] * b[1] < t[1] * b[0] ? 0 : 1;
    if (mu * b[first_to_vanish] >= t[first_to_vanish]) {
      sum = t[1 - first_to_vanish];
      mu = (sum - r) / b[1 - first_to_vanish];
    }
    const Float log_mu = log(mu);
    for (const std::size_t i : {0U, 1U}) it.coordinates[i] = coordinate(i, log_mu, k2_);
    complete(it, log_r, Float(-1), log_mu - k1_ * log_r, k1_ + r / (sum - r));
    return it;
  }

  /// Adds the third coordinate and the gauge to a section of radius r; `dr` and `dl` are the derivatives of ln r and of
  /// ln λ by the unknown.
  void complete(Iterate& it, const Float& log_r, const Float& dr, const Float& log_lambda, const Float& dl) const {
    Coordinate<Float>& z = it.coordinates[2];
    z = coordinate(2, log_lambda, k1_);
    const LogSum<Float> gauge = log_sum<Float>((k1_ + 1) * log_r, (k1_ + 1) * z.log_x);
    it.log_gauge = gauge.value / (k1_ + 1);
    it.derivative = (1 - gauge.weight) * dr + gauge.weight * z.sensitivity * dl;
  }

  /// Starts where the largest coordinate is that of the radial projection.
  [[nodiscard]] Float start(const Float& log_gauge) const {
    const Float log_r = log_norm(log_target_[0], log_target_[1], k2_) - log_gauge;
    if (by_radius_) return -log_r;
    const auto i = static_cast<std::size_t>(std::ranges::max_element(log_target_) - log_target_.begin());
    const Float log_x = log_target_[i] - log_gauge;
    const Float log_second = log_target_[i] + log(Float(-expm1(Float(-log_gauge))));
    const Float multiplier = log_second - (i == 2 ? k1_ : k2_) * log_x + 2 * log_axis_[i];
    return i == 2 ? Float(multiplier - log_ratio(log_r)) : multiplier;
  }

  [[nodiscard]] Iterate solve_multiplier(const Float& log_gauge) const {
    Float lower = -infinity_as<Float>();
    auto upper = infinity_as<Float>();
    // r is at most 1, and at most that of q itself.
    if (by_radius_) lower = -std::min<Float>(0, log_norm(log_target_[0], log_target_[1], k2_));
    Float expansion = 1;
    Float m = start(log_gauge);
    Iterate it = evaluate(m);
    bool trusted = true;  // whether Newton's last step at least halved the residual
    for (int i = 0; i < 300 && it.log_gauge != 0; ++i) {
      (it.log_gauge > 0 ? lower : upper) = m;
      const Float newton = -it.log_gauge / it.derivative;
      if (fabs(newton) <= resolution_.step * (1 + fabs(m))) {
        it = evaluate(m + newton);
        break;
      }
      const Float residual = fabs(it.log_gauge);
      const bool bracketed = isfinite(Float(upper - lower));
      if (m + newton > lower && m + newton < upper && (trusted || !bracketed)) {
        m += newton;
      } else if (bracketed) {
        const Float middle = (lower + upper) / 2;
        if (!(middle > lower && middle < upper)) break;
        m = middle;
      } else {
        m += copysign(expansion, it.log_gauge);
        expansion *= 2;
      }
      it = evaluate(m);
      trusted = !trusted || fabs(it.log_gauge) < residual / 2;
    }
    return it;
  }

  [[nodiscard]] Contact contact(const Iterate& it) const {
    Contact result{};
    for (std::size_t i = 0; i < 3; ++i) {
      const Float x = a_[i] * exp(it.coordinates[i].log_x);
      result.point[i] = static_cast<long double>(Float(copysign(x, q_[i])));
      // The second term as a share of q_i: accurate relative to itself, however small.
      result.normal[i] = static_cast<long double>(Float(q_[i] * exp(it.coordinates[i].log_weight)));
    }
    return result;
  }

  /// At e1 = 2 the pole (0, 0, a3) is a vertex; it is closest if the multiplier of z outweighs the section's.
  [[nodiscard]] bool apex_is_closest() const {
    const Float height = fabs(q_[2]) - a_[2];
    if (k1_ != 0 || !(height > 0)) return false;
    const Float multiplier = log(a_[2]) + log(height);
    const Float s1 = log(Float(a_[0] * fabs(q_[0])));
    const Float s2 = log(Float(a_[1] * fabs(q_[1])));
    if (k2_ == 0) return multiplier >= std::max(s1, s2);
    return multiplier >= log_norm<Float>(s1, s2, 1 / k2_);  // conjugate exponent: (p2 - 1)(q2 - 1) = 1
  }

  [[nodiscard]] Contact apex() const {
    const auto real = [](const Float& value) { return static_cast<long double>(value); };
    const Float pole = copysign(a_[2], q_[2]);
    return {{0.0L, 0.0L, real(pole)}, {real(q_[0]), real(q_[1]), real(q_[2] - pole)}};
  }

  /// The point itself (a certificate scales it to the surface) and the gradient of the gauge there.
  [[nodiscard]] Contact radial() const {
    const Float log_r = log_norm(log_target_[0], log_target_[1], k2_);
    std::array<Float, 3> logs;
    for (std::size_t i = 0; i < 3; ++i) {
      logs[i] = -infinity_as<Float>();
      if (q_[i] == 0) continue;
      logs[i] =
          (i == 2 ? Float(k1_ * log_target_[2]) : Float(k2_ * (log_target_[i] - log_r) + k1_ * log_r)) - log_axis_[i];
    }
    const Float largest = *std::ranges::max_element(logs);
    Contact result{};
    for (std::size_t i = 0; i < 3; ++i) {
      result.point[i] = static_cast<long double>(q_[i]);
      result.normal[i] = static_cast<long double>(Float(copysign(Float(exp(Float(logs[i] - largest))), q_[i])));
    }
    return result;
  }

  Resolution resolution_;
  std::array<Float, 3> q_;
  std::array<Float, 3> a_;
  std::array<Float, 3> log_target_;  ///< ln(|q_i| / a_i)
  std::array<Float, 3> log_axis_;    ///< ln(a_i / largest)
  Float k2_;
  Float k1_;
  bool by_radius_ = false;
};

// The closest point of a tapered solid, section by section, for any floating-point type.
//
// In the solid's own frame (docs/mathematics.md §18) a point of the surface is w = M u with N(u) = 1, M = (1 - k²) /
// (1 - k u_z/a3). At the height of w the solid's section is {‖(x/a1, y/a2)‖_p2 <= R}, and half the squared distance of
// q to it is convex in z, because it is the least over x and y of a convex function on a convex set. With ν the
// multiplier of the projection of (q1, q2) on the section and dR/dz from N(w) = 1 - k² + k z/a3, its derivative is
//     F(z) = z - q3 + ν (±|u_z/a3|^(p1-1) - k) / (a3 r^(p1-1)),     r the norm of u's section,
// which rises. The unknown is t = ln(r a3/|u_z|), which resolves the poles and the widest section alike.

using std::pow;

template <class Float>
class TaperedContactProblem {
 public:
  TaperedContactProblem(const Superquadric& solid, const Proposal& q, const Resolution& resolution)
      : solid_(solid),
        q_(q),
        resolution_(resolution),
        k_(taper_coefficient<Float>(solid.taper)),
        height_(solid.semi_axes[2]),
        excess_(excess(solid.exponents[0])),
        section_excess_(excess(solid.exponents[1])) {}

  [[nodiscard]] Contact solve() const {
    if (!outside()) return radial();
    const bool below = slope(equator(Float(1))) > 0;  // the widest section lies above the closest point
    const Float side = below ? -1 : 1;
    if (below && slope(equator(Float(-1))) < 0) return corner(equator(Float(1)));
    const auto rise = [&](const Float& t) { return Float(side * slope(place(t, side))); };  // falls with t
    Float low = -farthest();
    Float high = farthest();
    const Float at_low = rise(low);
    const Float at_high = rise(high);
    // Beyond both ends the solid's height changes no more in Float, but if p1 is near 1 its normal does. There
    // |u_z/a3|^(p1-1) may still be far from 0, like r^(p1-1) at the pole. The closest point has that height, and its
    // normal is q - x.
    if (at_low <= 0) return corner(place(low, side));
    if (at_high >= 0) return corner(place(high, side));
    if (!(at_low > 0 && at_high < 0)) return radial();  // numbers overflow
    std::uintmax_t most_steps = 100;
    // A few units in the last place of Float. Nearer, the bracket's ends are rounding errors, and the bracket is only
    // bisected.
    const Float last_places = 4 * std::numeric_limits<Float>::epsilon();
    const Float wanted = std::max(Float(resolution_.step * resolution_.step), last_places);
    const auto close = [&](const Float& a, const Float& b) { return fabs(b - a) <= wanted * (1 + fabs(a)); };
    std::tie(low, high) = boost::math::tools::toms748_solve(rise, low, high, at_low, at_high, close, most_steps);
    return contact(place((low + high) / 2, side));
  }

 private:
  /// A point of the surface but for x and y: u's section and height, and the solid's at that height.
  struct Place {
    Float side;     ///< 1 above the widest section, -1 below
    Float section;  ///< r
    Float z_share;  ///< |u_z| / a3
    Float radius;   ///< R
    Float z;
  };

  /// The projection of (q1, q2) on a section.
  struct Foot {
    Contact contact;   ///< normal: (q1, q2) - foot
    Float multiplier;  ///< ν
  };

  /// p - 1, as ContactProblem takes it.
  [[nodiscard]] Float excess(double e) const {
    if (2.0 - e <= resolution_.below_two) return Float(0);
    return Float(2) / std::max(e, resolution_.above_zero) - 1;
  }

  [[nodiscard]] Float farthest() const { return -log(Float(resolution_.surface)) + 4; }

  /// Returns whether q is so far outside that the height's rounding leaves digits of z - q3. Nearer, the normal at the
  /// radial projection is as good: a bound loses the square of the error.
  [[nodiscard]] bool outside() const {
    const auto nearest = std::max<long double>(1e6 * resolution_.surface, 1e-18L);
    return Boundary<long double>(solid_).gauge({std::fabs(q_[0]), std::fabs(q_[1]), q_[2]}) > 1.0L + nearest;
  }

  [[nodiscard]] Contact radial() const {
    const auto normal = Boundary<long double>(solid_).normal({std::fabs(q_[0]), std::fabs(q_[1]), q_[2]});
    return {q_, {std::copysign(normal[0], q_[0]), std::copysign(normal[1], q_[1]), normal[2]}};
  }

  [[nodiscard]] Place at(const Float& section, const Float& z_share, const Float& side) const {
    const Float scale = (1 - k_ * k_) / (1 - k_ * side * z_share);
    return {side, section, z_share, scale * section, height_ * side * scale * z_share};
  }

  [[nodiscard]] Place equator(const Float& side) const { return at(Float(1), Float(0), side); }

  [[nodiscard]] Place place(const Float& t, const Float& side) const {
    const Float p = excess_ + 1;
    const Float smaller = exp(Float(-log1p(Float(exp(Float(-p * fabs(t))))) / p));  // of the larger of the two shares
    const Float larger_ratio = exp(Float(-fabs(t)));
    return t > 0 ? at(smaller, smaller * larger_ratio, side) : at(smaller * larger_ratio, smaller, side);
  }

  [[nodiscard]] Foot foot(const Place& place) const {
    const auto radius = static_cast<long double>(place.radius);
    // With q3 = 0 any exponent along z is right; this one lets a rhombus be solved by its radius.
    const Superquadric section{{solid_.semi_axes[0], solid_.semi_axes[1], solid_.semi_axes[0]},
                               {1.0, solid_.exponents[1]}};
    const Proposal q{q_[0] / radius, q_[1] / radius, 0.0L};  // the section has the radius 1
    const Boundary<long double> boundary(section);
    if (boundary.gauge({std::fabs(q[0]), std::fabs(q[1]), 0.0L}) <= 1)
      return {{{q_[0], q_[1], 0}, {0, 0, 0}}, Float(0)};
    Contact found = ContactProblem<Float>(section, q, resolution_).solve();
    std::array<Float, 2> logs;
    for (const std::size_t i : {0U, 1U}) {
      found.point[i] *= radius;
      found.normal[i] *= radius;
      logs[i] = log(Float(std::fabs(found.normal[i]) * solid_.semi_axes[i]));
    }
    // The normal is ν times the gradient of a norm, whose dual norm, of the conjugate exponent, is 1.
    const Float log_multiplier = section_excess_ == 0 ? Float(std::max(logs[0], logs[1]))
                                                      : log_norm<Float>(logs[0], logs[1], 1 / section_excess_);
    return {found, exp(log_multiplier)};
  }

  /// ν times how fast the constraint rises with z.
  [[nodiscard]] Float push(const Place& place, const Float& multiplier) const {
    if (multiplier == 0) return Float(0);
    const Float of_height = excess_ == 0 ? Float(1) : Float(pow(place.z_share, excess_));
    return multiplier * (place.side * of_height - k_) / (height_ * pow(place.section, excess_));
  }

  [[nodiscard]] Float slope(const Place& place) const {
    return place.z - Float(q_[2]) + push(place, foot(place).multiplier);
  }

  [[nodiscard]] Contact contact(const Place& place) const {
    Foot found = foot(place);
    const Float across = found.multiplier == 0 ? Float(Float(q_[2]) - place.z) : push(place, found.multiplier);
    found.contact.point[2] = static_cast<long double>(place.z);
    found.contact.normal[2] = static_cast<long double>(across);
    return found.contact;
  }

  /// The contact on the widest section or at a pole, whose normal lies between the normals about it. For e1 = 2 these
  /// are an edge and a tip, for e1 near 2 nearly so.
  [[nodiscard]] Contact corner(const Place& place) const {
    Contact found = foot(place).contact;
    found.point[2] = static_cast<long double>(place.z);
    found.normal[2] = static_cast<long double>(Float(Float(q_[2]) - place.z));
    return found;
  }

  const Superquadric& solid_;
  Proposal q_;
  Resolution resolution_;
  Float k_;
  Float height_;          ///< a3
  Float excess_;          ///< p1 - 1
  Float section_excess_;  ///< p2 - 1
};

}  // namespace verisq::verify::logarithmic
