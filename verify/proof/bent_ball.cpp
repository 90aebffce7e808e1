/// Taylor's theorem for half the squared gauge, its second derivative bounded in pieces of the ways from c.
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
  PreciseInterval gauge;                         ///< g
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
  const PreciseInterval section(bounds.section(low[0], low[1], Direction::down),
                                bounds.section(high[0], high[1], Direction::up));
  s.gauge = PreciseInterval(bounds.norm(low, Direction::down), bounds.norm(high, Direction::up));
  s.x_in_section = share(s.of_axes[0], section);
  s.y_in_section = share(s.of_axes[1], section);
  s.section_in_gauge = share(section, s.gauge);
  s.z_in_gauge = share(s.of_axes[2], s.gauge);
  return s;
}

/// The gradient of g²/2, g (r/g)^(p₁-1) (X/r)^(p₂-1) / a1 and so on, with the signs of the coordinates.
PreciseVector gradient_of_half_square(const Superquadric& solid, const Shares& s, const PreciseVector& x) {
  const PreciseInterval p1 = primal_exponent<Real>(solid.exponents[0]).value - kOne;
  const PreciseInterval p2 = primal_exponent<Real>(solid.exponents[1]).value - kOne;
  const PreciseInterval section = s.gauge * pow(s.section_in_gauge, p1);
  const std::array<PreciseInterval, 3> sizes{section * pow(s.x_in_section, p2), section * pow(s.y_in_section, p2),
                                             s.gauge * pow(s.z_in_gauge, p1)};
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

/// Upper bound of e′G″e, G = g²/2, for steps e of length 1 and all points of a box. In it all of
///   (r/g)^(p₁-2) (X/r)^(p₂-2) e_x²/a1², the same of y, (Z/g)^(p₁-2) e_z²/a3²
/// are nonnegative, and the rest is (p₁ - 2) A C (m - w)² + (p₂ - 2) A B D (u - v)² times g², with
/// A C (m - w)² <= (1 + t) C (A m²) + (1 + 1/t) A (C w²) for t > 0 and <= A m² + C w²; the other term alike.
PreciseInterval second_derivative(const Superquadric& solid, const Shares& s, const PreciseInterval& stretch) {
  const PreciseInterval p1 = primal_exponent<Real>(solid.exponents[0]).value;
  const PreciseInterval p2 = primal_exponent<Real>(solid.exponents[1]).value;
  const PreciseInterval excess_1(std::max(Real(0), (p1 - kTwo).upper()));
  const PreciseInterval excess_2(std::max(Real(0), (p2 - kTwo).upper()));
  const TermBounds x = term_of(s.x_in_section, s.y_in_section, p2);
  const TermBounds y = term_of(s.y_in_section, s.x_in_section, p2);
  const TermBounds r = term_of(s.section_in_gauge, s.z_in_gauge, p1);
  const TermBounds z = term_of(s.z_in_gauge, s.section_in_gauge, p1);
  const auto inverse_square = [&](std::size_t i) { return kOne / square(PreciseInterval(Real(solid.semi_axes[i]))); };
  const PreciseInterval of_x = inverse_square(0);
  const PreciseInterval of_y = inverse_square(1);
  const PreciseInterval of_z = inverse_square(2) / square(stretch);
  const PreciseInterval plainly = larger(of_x * x.power, of_y * y.power) * (kOne + excess_2);
  const PreciseInterval section = smaller(plainly, raised(x, of_x, kTwo, y, of_y, kTwo, excess_2));
  const PreciseInterval slender(8);  // 1/t: e_z counts little in long solids
  return smaller(larger(section * r.power, of_z * z.power) * (kOne + excess_1),
                 smaller(raised(r, section, kTwo, z, of_z, kTwo, excess_1),
                         raised(r, section, kOne + kOne / slender, z, of_z, kOne + slender, excess_1)));
}

/// L: of the ways from c to all points within `reach` of q, (1 - s) integrated over each of eight pieces.
PreciseInterval weighted_second_derivative(const Superquadric& solid, const SuperquadricBounds<Real>& bounds,
                                           const BentBall& ball, const PreciseVector& reach,
                                           const PreciseInterval& stretch) {
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
    sum += (square(kOne - from) - square(kOne - to)) * second_derivative(solid, shares_at(solid, bounds, at), stretch);
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
  const Shares at_touching = shares_at(solid, bounds, ball.touching);
  const PreciseVector gradient = gradient_of_half_square(solid, at_touching, ball.touching);
  const PreciseInterval kappa = proposed_factor(gradient, ball.normal, stretch);
  const PreciseVector eta = gradient - ball.normal * kappa;
  const PreciseInterval eta_square = square(eta[0]) + square(eta[1]) + square(eta[2] / stretch);
  const PreciseInterval along_axis = ball.radius / (ball.query_stretch * cosine);
  const PreciseInterval second =
      weighted_second_derivative(solid, bounds, ball, {ball.radius, ball.radius, along_axis}, stretch);
  const Real excess = (kappa * (kOne - tau) - second).lower();
  if (!(excess > Real(0))) return false;
  return (square(at_touching.gauge) + eta_square / PreciseInterval(excess)).upper() <= Real(1);
}

}  // namespace verisq::verify
