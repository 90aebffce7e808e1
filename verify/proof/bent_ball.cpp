/// Taylor's theorem for a function that is at most a limit where the solid is, half the squared gauge or what the
/// section's norm is above the profile, its second derivative bounded in pieces of the ways from c.
#include "verify/proof/bent_ball.hpp"

#include <algorithm>

#include "verify/proof/certificate.hpp"
#include "verify/proof/mixed_norm.hpp"

namespace verisq::verify {

namespace {

const PreciseInterval kOne(1);
const PreciseInterval kTwo(2);

/// In [0, 1], of shares of a norm. 1 where the norm may be 0.
PreciseInterval share(const PreciseInterval& part, const PreciseInterval& norm) {
  if (!(norm.lower() > Real(0))) return {Real(0), Real(1)};
  const PreciseInterval quotient = part / norm;
  return {std::min(quotient.lower(), Real(1)), std::min(quotient.upper(), Real(1))};
}

/// Numbers of a point or a box of points in units of the semi-axes, without signs.
struct Shares {
  std::array<PreciseInterval, 3> of_axes;        ///< |x|/a1, |y|/a2, |z|/a3
  PreciseInterval section, gauge;                ///< r, g
  PreciseInterval x_in_section, y_in_section;    ///< X/r, Y/r
  PreciseInterval section_in_gauge, z_in_gauge;  ///< r/g, Z/g
};

Shares shares_at(const Superquadric& solid, const SuperquadricBounds<Real>& bounds, const PreciseVector& x) {
  const std::array<Real, 3> low = magnitudes<Real>(x, Direction::down);
  const std::array<Real, 3> high = magnitudes<Real>(x, Direction::up);
  Shares s;
  for (std::size_t i = 0; i < 3; ++i) {
    s.of_axes[i] = PreciseInterval(low[i], high[i]) / PreciseInterval(Real(solid.semi_axes[i]));
  }
  s.section =
      PreciseInterval(bounds.section(low[0], low[1], Direction::down), bounds.section(high[0], high[1], Direction::up));
  s.gauge = PreciseInterval(bounds.norm(low, Direction::down), bounds.norm(high, Direction::up));
  s.x_in_section = share(s.of_axes[0], s.section);
  s.y_in_section = share(s.of_axes[1], s.section);
  s.section_in_gauge = share(s.section, s.gauge);
  s.z_in_gauge = share(s.of_axes[2], s.gauge);
  return s;
}

/// From the derivatives by r and by |z|/a3, with the signs of the coordinates of x.
PreciseVector gradient_of(const Superquadric& solid, const Shares& s, const PreciseVector& x,
                          const PreciseInterval& by_section, const PreciseInterval& by_z) {
  const PreciseInterval p2 = primal_exponent<Real>(solid.exponents[1]).value - kOne;
  const std::array<PreciseInterval, 3> sizes{by_section * pow(s.x_in_section, p2), by_section * pow(s.y_in_section, p2),
                                             by_z};
  PreciseVector result;
  for (std::size_t i = 0; i < 3; ++i) {
    const PreciseInterval size = sizes[i] / PreciseInterval(Real(solid.semi_axes[i]));
    const PreciseInterval either(-size.upper(), size.upper());
    result[i] = x[i].lower() >= Real(0) ? size : x[i].upper() <= Real(0) ? -size : either;
  }
  return result;
}

/// Upper bound of A^s (1 - A) for A in [0, 1], s = 1 - 2/p: its largest value s^s / (1 + s)^(1 + s) falls with s.
PreciseInterval largest_mixture(const PreciseInterval& p) {
  const PreciseInterval s((kOne - kTwo / p).lower());
  if (!(s.lower() > Real(0x1p-10))) return kOne;
  return (pow(s, s) / pow(kOne + s, kOne + s)).upper();
}

/// Of one of the terms (share)^(p-2) e²: what it is at most, and what it is times (the other share)^p.
struct TermBounds {
  PreciseInterval power, mixed;
};

TermBounds term_of(const PreciseInterval& ratio, const PreciseInterval& other, const PreciseInterval& p) {
  const PreciseInterval largest(ratio.upper());
  const PreciseInterval power = pow(largest, PreciseInterval(std::max(Real(0), (p - kTwo).lower()))).upper();
  const PreciseInterval mixed = power * pow(PreciseInterval(other.upper()), PreciseInterval(p.lower()));
  return {power, std::min(mixed.upper(), largest_mixture(p).upper())};
}

PreciseInterval larger(const PreciseInterval& a, const PreciseInterval& b) {
  return std::max(a.upper(), b.upper());
}

PreciseInterval smaller(const PreciseInterval& a, const PreciseInterval& b) {
  return std::min(a.upper(), b.upper());
}

/// The larger of two terms with their scales, raised by `excess` times (m - w)² or (u - v)² with their weights: those
/// are at most the terms themselves, or the given multiples of the mixed ones.
PreciseInterval raised(const TermBounds& a, const PreciseInterval& scale_a, const PreciseInterval& multiple_a,
                       const TermBounds& b, const PreciseInterval& scale_b, const PreciseInterval& multiple_b,
                       const PreciseInterval& excess) {
  return larger(scale_a * (a.power + excess * multiple_a * a.mixed),
                scale_b * (b.power + excess * multiple_b * b.mixed));
}

/// Upper bound of B^s (1 + 2 (p - 2) (1 - B)) for B in [0, 1], s = 1 - 2/p: its value at B = (2p - 3) / (4 (p - 1)).
PreciseInterval largest_raised(const PreciseInterval& p) {
  const PreciseInterval at = (kTwo * p - PreciseInterval(3)) / (PreciseInterval(4) * (p - kOne));
  return (kTwo * p * pow(at, kTwo - kTwo / p)).upper();
}

PreciseInterval inverse_square(const Superquadric& solid, std::size_t axis) {
  return kOne / square(PreciseInterval(Real(solid.semi_axes[axis])));
}

PreciseInterval excess_of(const PreciseInterval& p) {
  return PreciseInterval(std::max(Real(0), (p - kTwo).upper()));
}

/// Upper bound of the second derivative of r²/2 along steps of length 1 in the section: of
///   (X/r)^(p₂-2) e_x²/a1², the same of y, and (p₂ - 2) r² B D (u - v)²,
/// the last of which is at most (p₂ - 2) times the first two, or 2 (p₂ - 2) times the mixed ones.
PreciseInterval section_derivative(const Superquadric& solid, const Shares& s) {
  const PreciseInterval p2 = primal_exponent<Real>(solid.exponents[1]).value;
  const PreciseInterval excess = excess_of(p2);
  const TermBounds x = term_of(s.x_in_section, s.y_in_section, p2);
  const TermBounds y = term_of(s.y_in_section, s.x_in_section, p2);
  const PreciseInterval of_x = inverse_square(solid, 0);
  const PreciseInterval of_y = inverse_square(solid, 1);
  const auto raised_term = [&](const TermBounds& t) {
    return smaller(largest_raised(p2), t.power + kTwo * excess * t.mixed);
  };
  return smaller(larger(of_x * x.power, of_y * y.power) * (kOne + excess),
                 larger(of_x * raised_term(x), of_y * raised_term(y)));
}

/// Upper bound of e′G″e, G = g²/2, for steps e of length 1 and all points of a box. In it all of
///   (r/g)^(p₁-2) times the second derivative of r²/2, and (Z/g)^(p₁-2) e_z²/a3²
/// are nonnegative, and the rest is (p₁ - 2) A C (m - w)² times g², with
/// A C (m - w)² <= (1 + t) C (A m²) + (1 + 1/t) A (C w²) for t > 0 and <= A m² + C w².
PreciseInterval second_derivative_of_gauge(const Superquadric& solid, const Shares& s, const PreciseInterval& stretch) {
  const PreciseInterval p1 = primal_exponent<Real>(solid.exponents[0]).value;
  const PreciseInterval excess = excess_of(p1);
  const TermBounds r = term_of(s.section_in_gauge, s.z_in_gauge, p1);
  const TermBounds z = term_of(s.z_in_gauge, s.section_in_gauge, p1);
  const PreciseInterval section = section_derivative(solid, s);
  const PreciseInterval of_z = inverse_square(solid, 2) / square(stretch);
  const PreciseInterval slender(8);  // 1/t: e_z counts little in long solids
  return smaller(larger(section * r.power, of_z * z.power) * (kOne + excess),
                 smaller(raised(r, section, kTwo, z, of_z, kTwo, excess),
                         raised(r, section, kOne + kOne / slender, z, of_z, kOne + slender, excess)));
}

/// Of P = (r² - h²)/2, likewise, where |z|/a3 is at most `farthest`, below 1: -h²/2 has the second derivative
///   Z^(p₁-2) (1 - N)^(2/p₁-2) (p₁ - 1 - N)/a3², N = Z^p₁.
PreciseInterval second_derivative_by_profile(const Superquadric& solid, const Shares& s, const PreciseInterval& stretch,
                                             const PreciseInterval& farthest) {
  const PreciseInterval p1 = primal_exponent<Real>(solid.exponents[0]).value;
  const PreciseInterval z = smaller(s.of_axes[2], farthest);
  const PreciseInterval rest((kOne - pow(z, p1)).lower());
  const PreciseInterval power(std::max(Real(0), (p1 - kTwo).lower()));
  const PreciseInterval along = pow(z, power) * pow(rest, kTwo / p1 - kTwo) * (p1 - kOne) * inverse_square(solid, 2);
  return larger(section_derivative(solid, s), along / square(stretch));
}

/// The norm in which f is measured in the ball, and how far its points lie from q, both unbent.
struct BallMetric {
  PreciseInterval stretch;  ///< a
  PreciseInterval tau;
  PreciseVector reach;
};

/// L: of the ways from c to all points within reach of q, (1 - s) integrated over each of eight pieces.
template <class SecondDerivative>
PreciseInterval weighted(const SuperquadricBounds<Real>& bounds, const Superquadric& solid, const BentBall& ball,
                         const PreciseVector& reach, const SecondDerivative& second) {
  constexpr int pieces = 8;
  PreciseInterval sum(0);
  for (int i = 0; i < pieces; ++i) {
    const PreciseInterval from = PreciseInterval(i) / PreciseInterval(pieces);
    const PreciseInterval to = PreciseInterval(i + 1) / PreciseInterval(pieces);
    PreciseVector at;
    for (std::size_t j = 0; j < 3; ++j) {
      const PreciseInterval end = ball.query[j] + PreciseInterval(-reach[j].upper(), reach[j].upper());
      at[j] = hull((kOne - from) * ball.touching[j] + from * end, (kOne - to) * ball.touching[j] + to * end);
    }
    sum += (square(kOne - from) - square(kOne - to)) * second(shares_at(solid, bounds, at));
  }
  return sum;
}

/// The factor of v that is nearest to the gradient in the dual norm, or 0; any number is as right.
PreciseInterval proposed_factor(const PreciseVector& gradient, const PreciseVector& v, const PreciseInterval& stretch) {
  const Proposal g = midpoint(gradient);
  const Proposal n = midpoint(v);
  const long double a = stretch.lower().to_long_double();
  const long double factor =
      (n[0] * g[0] + n[1] * g[1] + n[2] * g[2] / (a * a)) / (n[0] * n[0] + n[1] * n[1] + n[2] * n[2] / (a * a));
  return std::isfinite(factor) ? Real(std::max(factor, 0.0L)) : Real(0);
}

/// Whether a function is at most half of `limit` in the ball: `gradient` and `twice` its value are those at c, `second`
/// bounds its second derivative.
template <class SecondDerivative>
bool stays_below(const SuperquadricBounds<Real>& bounds, const Superquadric& solid, const BentBall& ball,
                 const BallMetric& metric, const PreciseVector& gradient, const PreciseInterval& twice,
                 const Real& limit, const SecondDerivative& second) {
  const PreciseInterval kappa = proposed_factor(gradient, ball.normal, metric.stretch);
  const PreciseVector eta = gradient - ball.normal * kappa;
  const PreciseInterval eta_square = square(eta[0]) + square(eta[1]) + square(eta[2] / metric.stretch);
  const PreciseInterval most = weighted(bounds, solid, ball, metric.reach, second);
  const Real excess = (kappa * (kOne - metric.tau) - most).lower();
  return excess > Real(0) && (twice + eta_square / PreciseInterval(excess)).upper() <= limit;
}

bool gauge_stays_below(const SuperquadricBounds<Real>& bounds, const Superquadric& solid, const BentBall& ball,
                       const BallMetric& metric) {
  const Shares s = shares_at(solid, bounds, ball.touching);
  const PreciseInterval p1 = primal_exponent<Real>(solid.exponents[0]).value - kOne;
  const PreciseVector gradient =
      gradient_of(solid, s, ball.touching, s.gauge * pow(s.section_in_gauge, p1), s.gauge * pow(s.z_in_gauge, p1));
  return stays_below(bounds, solid, ball, metric, gradient, square(s.gauge), Real(1),
                     [&](const Shares& at) { return second_derivative_of_gauge(solid, at, metric.stretch); });
}

/// P. False unless all ways stay between the ends.
bool profile_stays_below(const SuperquadricBounds<Real>& bounds, const Superquadric& solid, const BentBall& ball,
                         const BallMetric& metric) {
  const Real highest = std::max(abs(ball.touching[2]).upper(), (abs(ball.query[2]) + metric.reach[2]).upper());
  const PreciseInterval farthest = PreciseInterval(highest) / PreciseInterval(Real(solid.semi_axes[2]));
  const PreciseInterval p1 = primal_exponent<Real>(solid.exponents[0]).value;
  if (!((kOne - pow(farthest, p1)).lower() > Real(0))) return false;
  const Shares s = shares_at(solid, bounds, ball.touching);
  const PreciseInterval& z = s.of_axes[2];
  const PreciseInterval rest = kOne - pow(z, p1);
  const PreciseVector gradient =
      gradient_of(solid, s, ball.touching, s.section, pow(z, p1 - kOne) * pow(rest, kTwo / p1 - kOne));
  const PreciseInterval twice = square(s.section) - pow(rest, kTwo / p1);
  return stays_below(bounds, solid, ball, metric, gradient, twice, Real(0), [&](const Shares& at) {
    return second_derivative_by_profile(solid, at, metric.stretch, farthest);
  });
}

}  // namespace

bool is_bent_ball_contained(const Superquadric& solid, const PreciseInterval& curvature, const BentBall& ball) {
  if (is_tapered(solid) || std::ranges::max(solid.exponents) > 1.0) return false;
  if (!(ball.query_stretch.lower() > Real(0) && ball.touching_stretch.lower() > Real(0))) return false;
  const PreciseInterval sine = curvature * ball.radius / ball.query_stretch;
  const PreciseInterval cosine = sqrt(PreciseInterval(std::max(Real(0), (kOne - square(sine)).lower())));
  if (!(cosine.lower() > Real(0))) return false;
  const PreciseInterval turn = square(sine / cosine);  // at least θ², because θ <= tan θ
  if (!(turn.upper() <= Real(1))) return false;
  const PreciseInterval flattening =
      (kOne - turn / PreciseInterval(3)) * (kOne - turn / kTwo) - kTwo * turn / PreciseInterval(3);
  // Both are right with any smaller number in their place, too.
  const Real square_of_stretch = (ball.touching_stretch * ball.query_stretch * flattening).lower();
  if (!(square_of_stretch > Real(0))) return false;
  const PreciseInterval stretch(square_root(square_of_stretch, Direction::down));
  const PreciseInterval tau = curvature * ball.radius / stretch;
  // c does not lie a whole turn away: θ is at most an eighth of one.
  const PreciseInterval apart = abs(ball.touching[2] - ball.query[2]);
  if (!((curvature * apart).upper() < Real(3))) return false;

  const SuperquadricBounds<Real> bounds(solid);
  const PreciseInterval along_axis = ball.radius / (ball.query_stretch * cosine);
  const BallMetric metric{stretch, tau, {ball.radius, ball.radius, along_axis}};
  return profile_stays_below(bounds, solid, ball, metric) || gauge_stays_below(bounds, solid, ball, metric);
}

}  // namespace verisq::verify
