#include "verify/exterior.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

// In units of the semi-axes, X_i = x_i / a_i, the conditions of design 2, §3 are, with k_i = p_i - 1,
//     X + (μ / a1^2) X^k2 = q1 / a1,     Y alike,     Z + (λ / a3^2) Z^k1 = q3 / a3,
//     λ = μ r^(p2 - p1),     r = ‖(X, Y)‖_p2,     g = ‖(r, Z)‖_p1 = 1.
// Given μ, each equation has one root. X and Y fall as μ rises. So does Z, because λ rises: D(r), the squared distance
// of (q1, q2) to the section ‖(X, Y)‖_p2 <= r, is convex, so its multiplier μ r^k2 rises as r falls, and
// λ = (μ r^k2) r^(-k1). Hence g falls as μ rises, and the whole problem is one monotone equation in ln μ, solved by
// Newton steps inside a bracket. Everything is kept in logarithms.

namespace verisq::verify {

namespace {

using Float = long double;
constexpr Float kInfinity = std::numeric_limits<Float>::infinity();

/// Points this close to the surface, in units of the solid, are projected along the ray: their ln g is rounding error.
constexpr Float kSurface = 1e-16L;

/// log(e^a + e^b) and the weight e^b / (e^a + e^b) of the second term.
struct LogSum {
  Float value;
  Float weight;
};

LogSum log_sum(Float a, Float b) {
  if (a == -kInfinity) return {b, b == -kInfinity ? 0.0L : 1.0L};
  if (b == -kInfinity) return {a, 0.0L};
  const Float difference = b - a;
  const Float small = std::exp(-std::fabs(difference));
  return {std::max(a, b) + std::log1p(small), (difference > 0.0L ? 1.0L : small) / (1.0L + small)};
}

/// ln ‖(e^a, e^b)‖ with exponent p = k + 1.
Float log_norm(Float a, Float b, Float k) {
  if (std::max(a, b) == -kInfinity) return -kInfinity;
  return log_sum(a * (k + 1.0L), b * (k + 1.0L)).value / (k + 1.0L);
}

/// Root of X + e^c X^k = e^s in logarithms.
struct Coordinate {
  Float log_x;        ///< ln X; minus infinity where X = 0
  Float log_weight;   ///< ln of the second term's share of e^s
  Float sensitivity;  ///< d ln X / d c, not positive
};

/// The linear case k = 0 (e = 2): X = max(0, e^s - e^c).
Coordinate solve_linear(Float s, Float c) {
  if (c >= s) return {-kInfinity, 0.0L, 0.0L};
  const Float weight = std::exp(c - s);
  return {s + std::log1p(-weight), c - s, -weight / (1.0L - weight)};
}

Coordinate solve_coordinate(Float s, Float c, Float k) {
  if (s == -kInfinity || c == kInfinity) return {-kInfinity, 0.0L, 0.0L};
  if (k == 0.0L) return solve_linear(s, c);
  // The left side is convex in ln X, and at this start it is at least the right side: Newton descends monotonically.
  Float u = std::min(s, (s - c) / k);
  LogSum sum = log_sum(u, c + k * u);
  for (int i = 0; i < 64; ++i) {
    const Float step = (sum.value - s) / ((1.0L - sum.weight) + k * sum.weight);
    u -= step;
    sum = log_sum(u, c + k * u);
    if (!(step > 1e-10L * (1.0L + std::fabs(u)))) break;  // the next error is of the order of step^2
  }
  const Float log_weight = -log_sum(0.0L, u - (c + k * u)).value;
  return {u, log_weight, -sum.weight / ((1.0L - sum.weight) + k * sum.weight)};
}

class ContactProblem {
 public:
  ContactProblem(const Superquadric& solid, const Proposal& q)
      : k2_(proposal_excess(solid.exponents[1])), k1_(proposal_excess(solid.exponents[0])) {
    for (std::size_t i = 0; i < 3; ++i) {
      q_[i] = q[i];
      a_[i] = solid.semi_axes[i];
      log_target_[i] = std::log(std::fabs(q[i]) / a_[i]);
    }
    const Float largest = *std::ranges::max_element(a_);
    for (std::size_t i = 0; i < 3; ++i) log_axis_[i] = std::log(a_[i] / largest);
    if (q[0] == 0.0L || q[1] == 0.0L) k2_ = k1_;  // the section is a segment: its norm has any exponent
    by_radius_ = radius_is_unknown();
  }

  [[nodiscard]] Contact solve() const {
    const Float log_gauge = log_gauge_of(log_target_[0], log_target_[1], log_target_[2]);
    if (!(log_gauge > kSurface)) return radial();
    if (apex_is_closest()) return apex();
    return contact(solve_multiplier(log_gauge));
  }

 private:
  /// State at one value of the unknown m: ln μ, or -ln r for a rhombic section.
  struct Iterate {
    std::array<Coordinate, 3> coordinates;
    Float log_gauge;   ///< ln g(x): positive while m is too small
    Float derivative;  ///< d log_gauge / dm, not positive
  };

  /// p - 1 = (2 - e)/e of a nearby exponent that logarithms in long double can resolve. Moving e by δ moves the solid
  /// by less than δ of its size, which a proposal may.
  static Float proposal_excess(double e) {
    if (2.0 - e < 1e-10) return 0.0L;
    const Float resolved = std::max(e, 1e-7);
    return (2.0L - resolved) / resolved;
  }

  [[nodiscard]] Float log_gauge_of(Float x, Float y, Float z) const { return log_norm(log_norm(x, y, k2_), z, k1_); }

  /// ln λ - ln μ = (p2 - p1) ln r
  [[nodiscard]] Float log_ratio(Float log_r) const { return k1_ == k2_ ? 0.0L : (k2_ - k1_) * log_r; }

  /// Where the section is a rhombus (e2 = 2), r may fall below the rounding error of X and Y, while λ contains a power
  /// of it: then ln r is the well-conditioned unknown. Decided at half the section radius of q itself.
  [[nodiscard]] bool radius_is_unknown() const {
    if (k2_ != 0.0L || k1_ == 0.0L) return false;
    return evaluate_radius(log_norm(log_target_[0], log_target_[1], k2_) - std::log(2.0L)).log_gauge > 0.0L;
  }

  [[nodiscard]] Iterate evaluate(Float m) const { return by_radius_ ? evaluate_radius(-m) : evaluate_multiplier(m); }

  [[nodiscard]] Iterate evaluate_multiplier(Float log_mu) const {
    Iterate it{};
    auto& [x, y, z] = it.coordinates;
    x = solve_coordinate(log_target_[0], log_mu - 2.0L * log_axis_[0], k2_);
    y = solve_coordinate(log_target_[1], log_mu - 2.0L * log_axis_[1], k2_);
    const LogSum section = log_sum((k2_ + 1.0L) * x.log_x, (k2_ + 1.0L) * y.log_x);
    const Float log_r = section.value / (k2_ + 1.0L);
    const Float dr = (1.0L - section.weight) * x.sensitivity + section.weight * y.sensitivity;
    complete(it, log_r, dr, log_mu + log_ratio(log_r), 1.0L + (k2_ - k1_) * dr);
    return it;
  }

  /// Projects on the rhombus X + Y = r first: X = t1 - μ/a1^2, Y = t2 - μ/a2^2, or zero where that is negative.
  [[nodiscard]] Iterate evaluate_radius(Float log_r) const {
    Iterate it{};
    const Float r = std::exp(log_r);
    const std::array<Float, 2> t{std::exp(log_target_[0]), std::exp(log_target_[1])};
    const std::array<Float, 2> b{std::exp(-2.0L * log_axis_[0]), std::exp(-2.0L * log_axis_[1])};
    Float sum = t[0] + t[1];
    Float mu = (sum - r) / (b[0] + b[1]);
    const std::size_t first_to_vanish = t[0] * b[1] < t[1] * b[0] ? 0 : 1;
    if (mu * b[first_to_vanish] >= t[first_to_vanish]) {
      sum = t[1 - first_to_vanish];
      mu = (sum - r) / b[1 - first_to_vanish];
    }
    for (const std::size_t i : {0U, 1U}) it.coordinates[i] = solve_linear(log_target_[i], std::log(mu * b[i]));
    complete(it, log_r, -1.0L, std::log(mu) - k1_ * log_r, k1_ + r / (sum - r));
    return it;
  }

  /// Adds the third coordinate and the gauge to a section of radius r; `dr` and `dl` are the derivatives of ln r and of
  /// ln λ by the unknown.
  void complete(Iterate& it, Float log_r, Float dr, Float log_lambda, Float dl) const {
    Coordinate& z = it.coordinates[2];
    z = solve_coordinate(log_target_[2], log_lambda - 2.0L * log_axis_[2], k1_);
    const LogSum gauge = log_sum((k1_ + 1.0L) * log_r, (k1_ + 1.0L) * z.log_x);
    it.log_gauge = gauge.value / (k1_ + 1.0L);
    it.derivative = (1.0L - gauge.weight) * dr + gauge.weight * z.sensitivity * dl;
  }

  /// Starts where the largest coordinate is that of the radial projection.
  [[nodiscard]] Float start(Float log_gauge) const {
    const Float log_r = log_norm(log_target_[0], log_target_[1], k2_) - log_gauge;
    if (by_radius_) return -log_r;
    const auto i = static_cast<std::size_t>(std::ranges::max_element(log_target_) - log_target_.begin());
    const Float log_x = log_target_[i] - log_gauge;
    const Float log_second = log_target_[i] + std::log(-std::expm1(-log_gauge));
    const Float multiplier = log_second - (i == 2 ? k1_ : k2_) * log_x + 2.0L * log_axis_[i];
    return i == 2 ? multiplier - log_ratio(log_r) : multiplier;
  }

  [[nodiscard]] Iterate solve_multiplier(Float log_gauge) const {
    // r is at most 1, and at most that of q itself.
    Float lower = by_radius_ ? -std::min(0.0L, log_norm(log_target_[0], log_target_[1], k2_)) : -kInfinity;
    Float upper = kInfinity;
    Float expansion = 1.0L;
    Float m = start(log_gauge);
    Iterate it = evaluate(m);
    bool trusted = true;  // whether Newton's last step at least halved the residual
    for (int i = 0; i < 300 && it.log_gauge != 0.0L; ++i) {
      (it.log_gauge > 0.0L ? lower : upper) = m;
      const Float newton = -it.log_gauge / it.derivative;
      if (std::fabs(newton) <= 1e-10L * (1.0L + std::fabs(m))) {  // the next error is of the order of its square
        it = evaluate(m + newton);
        break;
      }
      const Float residual = std::fabs(it.log_gauge);
      const bool bracketed = std::isfinite(upper - lower);
      if (m + newton > lower && m + newton < upper && (trusted || !bracketed)) {
        m += newton;
      } else if (bracketed) {
        const Float middle = 0.5L * (lower + upper);
        if (!(middle > lower && middle < upper)) break;
        m = middle;
      } else {
        m += std::copysign(expansion, it.log_gauge);
        expansion *= 2.0L;
      }
      it = evaluate(m);
      trusted = !trusted || std::fabs(it.log_gauge) < 0.5L * residual;
    }
    return it;
  }

  [[nodiscard]] Contact contact(const Iterate& it) const {
    Contact result{};
    for (std::size_t i = 0; i < 3; ++i) {
      result.point[i] = std::copysign(a_[i] * std::exp(it.coordinates[i].log_x), q_[i]);
      result.normal[i] = q_[i] * std::exp(it.coordinates[i].log_weight);  // accurate relative to itself
    }
    return result;
  }

  /// At e1 = 2 the pole (0, 0, a3) is a vertex; it is closest where the multiplier of z outweighs the section's.
  [[nodiscard]] bool apex_is_closest() const {
    if (k1_ != 0.0L || !(std::fabs(q_[2]) > a_[2])) return false;
    const Float multiplier = std::log(a_[2]) + std::log(std::fabs(q_[2]) - a_[2]);
    const Float s1 = std::log(a_[0] * std::fabs(q_[0]));
    const Float s2 = std::log(a_[1] * std::fabs(q_[1]));
    if (k2_ == 0.0L) return multiplier >= std::max(s1, s2);
    return multiplier >= log_norm(s1, s2, 1.0L / k2_);  // conjugate exponent: (p2 - 1)(q2 - 1) = 1
  }

  [[nodiscard]] Contact apex() const {
    const Float pole = std::copysign(a_[2], q_[2]);
    return {{0.0L, 0.0L, pole}, {q_[0], q_[1], q_[2] - pole}};
  }

  /// The point itself (a certificate scales it to the surface) and the gradient of the gauge there.
  [[nodiscard]] Contact radial() const {
    const Float log_r = log_norm(log_target_[0], log_target_[1], k2_);
    std::array<Float, 3> logs{};
    for (std::size_t i = 0; i < 2; ++i) {
      logs[i] = log_target_[i] == -kInfinity ? -kInfinity : k2_ * (log_target_[i] - log_r) - log_axis_[i] + k1_ * log_r;
    }
    logs[2] = log_target_[2] == -kInfinity ? -kInfinity : k1_ * log_target_[2] - log_axis_[2];
    const Float largest = *std::ranges::max_element(logs);
    Contact result{};
    for (std::size_t i = 0; i < 3; ++i) {
      result.point[i] = q_[i];
      result.normal[i] = std::copysign(std::exp(logs[i] - largest), q_[i]);
    }
    return result;
  }

  std::array<Float, 3> q_{};
  std::array<Float, 3> a_{};
  std::array<Float, 3> log_target_{};  ///< ln(|q_i| / a_i)
  std::array<Float, 3> log_axis_{};    ///< ln(a_i / largest)
  Float k2_;
  Float k1_;
  bool by_radius_ = false;
};

}  // namespace

Contact closest_contact(const Superquadric& solid, const Proposal& q) {
  Contact contact = ContactProblem(solid, q).solve();
  // Numbers hundreds of decades apart exceed even logarithms in long double; the ray from the centre is never useless.
  if (!usable(contact.point)) contact.point = q;
  if (!usable(contact.normal)) contact.normal = q;
  return contact;
}

}  // namespace verisq::verify
