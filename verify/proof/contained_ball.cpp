/// The balls of posed_superquadric.hpp.
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "verify/proof/posed_superquadric.hpp"
#include "verify/solids/superquadric.hpp"

// Let d1, d2, d3 >= 0 with q + d_i proven in the solid K, and c with c·d_i >= t |c|, c >= 0, not 0. A vector v of the
// cone of the d_i with |v| <= t is v = Σ l_i d_i, l_i >= 0, and t |c| Σ l_i <= c·v <= t |c|. So q + v lies in the hull
// of q and the q + d_i, which lies in K. If cones cover the octant, the ball of radius t about q lies in K, because g
// is monotone in each |coordinate| and |q_k + v_k| <= |q_k| + |v_k|. The best c points at the point of the face d1 d2
// d3 closest to q. A cone whose face comes too close is cut in two, so that two new faces come closer to the surface.
// For a tapered solid g is monotone in |x| and |y| alone: there the cones cover z < 0, too.

namespace verisq::verify {

namespace {

using Float = long double;
using Vector = Proposal;

constexpr int kBudget = 50'000;     ///< points of the surface
constexpr int kDeepestLevel = 50;   ///< of bisections: directions stay exact
constexpr Float kMargin = 0x1p-62;  ///< of the gauge: the loss of a proposed surface point by rounding

Float squared_distance(const Vector& a, const Vector& b) {
  return (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]);
}

/// q + d lies in the solid: proven.
struct Corner {
  Vector direction;  ///< exact: barycentric coordinates that are multiples of a power of two
  PreciseVector d;   ///< exact: the direction times a number of 64 bits
  Vector nearest_d;  ///< approximate, for proposals
};

struct Cone {
  std::array<std::size_t, 3> corners;  ///< in a plane two corners, one of them repeated
  int level;                           ///< bisections so far
};

class BallProof {
 public:
  BallProof(const RevolvedPoint& point, double radius)
      : solid_(point.solid), bounds_(point.solid), radius_(Real(radius)), planar_(point.planar), q_(point.q) {
    const std::array<Real, 3> q = magnitudes<Real>(point.q, Direction::up);
    const std::size_t folded = bounds_.is_tapered() ? 2 : 3;
    for (std::size_t k = 0; k < folded; ++k) q_[k] = q[k];  // by monotony enough for the whole box
    nearest_q_ = midpoint(q_);
  }

  [[nodiscard]] bool succeeds(const Hook& interrupted) {
    const std::size_t x = add_corner({1, 0, 0});
    const std::size_t z = add_corner({0, 0, 1});
    const std::size_t y = planar_ ? z : add_corner({0, 1, 0});
    std::vector<Cone> open{{{x, y, z}, 0}};
    if (bounds_.is_tapered()) {
      const std::size_t below = add_corner({0, 0, -1});
      open.push_back({{x, planar_ ? below : y, below}, 0});
    }
    while (!open.empty()) {
      const Cone cone = open.back();
      open.pop_back();
      if (proven(cone)) continue;
      if (cone.level == kDeepestLevel || corners_.size() >= kBudget || (interrupted && interrupted())) return false;
      for (const Cone& half : bisect(cone)) open.push_back(half);
    }
    return true;
  }

 private:
  [[nodiscard]] bool proven(const Cone& cone) const {
    const auto& [a, b, c] = cone.corners;
    const Vector foot =
        proposed::closest_to_origin({corners_[a].nearest_d, corners_[b].nearest_d, corners_[c].nearest_d});
    const Proposal axis{std::max<Float>(foot[0], 0), std::max<Float>(foot[1], 0),
                        bounds_.is_tapered() ? foot[2] : std::max<Float>(foot[2], 0)};
    if (!usable(axis)) return false;
    const PreciseVector normal = precise(axis);
    const Real least = (radius_ * length<Real>(normal)).upper();
    return std::ranges::all_of(cone.corners, [&](std::size_t i) { return normal.dot(corners_[i].d).lower() >= least; });
  }

  std::size_t add_corner(const Vector& direction) {
    corners_.push_back(proven_corner(direction));
    return corners_.size() - 1;
  }

  /// The corner as far along the ray as can be proven; q itself at worst.
  [[nodiscard]] Corner proven_corner(const Vector& direction) const {
    for (Float margin = kMargin; margin < 1; margin *= 8) {
      const Float reach = proposed::exit(solid_, nearest_q_, direction, 1 - margin);
      const PreciseVector d = precise(direction) * PreciseInterval(Real(reach));
      // Corners behind q would span no cone about the direction: the lemma requires reach >= 0.
      if (std::isfinite(reach) && reach >= 0 && inside(d)) return {direction, d, midpoint(d)};
    }
    return {direction, precise(Proposal{}), {}};
  }

  [[nodiscard]] bool inside(const PreciseVector& d) const { return bounds_.gauge_up(q_ + d) <= Real(1); }

  /// Cuts the longest edge of the face at the middle direction.
  [[nodiscard]] std::array<Cone, 2> bisect(const Cone& cone) {
    constexpr std::array<std::pair<std::size_t, std::size_t>, 3> edges{{{0, 1}, {1, 2}, {2, 0}}};
    std::pair<std::size_t, std::size_t> longest{};
    Float squared = -1;
    for (const auto& [i, j] : edges) {
      const Float length = squared_distance(corners_[cone.corners[i]].nearest_d, corners_[cone.corners[j]].nearest_d);
      if (length <= squared || cone.corners[i] == cone.corners[j]) continue;
      squared = length;
      longest = {cone.corners[i], cone.corners[j]};
    }
    const std::size_t middle = middle_of(longest.first, longest.second);
    Cone first{cone.corners, cone.level + 1};
    Cone second = first;
    std::ranges::replace(first.corners, longest.second, middle);
    std::ranges::replace(second.corners, longest.first, middle);
    return {first, second};
  }

  [[nodiscard]] std::size_t middle_of(std::size_t a, std::size_t b) {
    const auto [position, created] = middles_.try_emplace(std::minmax(a, b), 0);
    if (created) {
      const Vector& u = corners_[a].direction;
      const Vector& v = corners_[b].direction;
      position->second = add_corner({(u[0] + v[0]) / 2, (u[1] + v[1]) / 2, (u[2] + v[2]) / 2});
    }
    return position->second;
  }

  Superquadric solid_;
  SuperquadricBounds<Real> bounds_;
  PreciseInterval radius_;
  bool planar_;
  PreciseVector q_;
  Vector nearest_q_{};
  std::vector<Corner> corners_;
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> middles_;
};

}  // namespace

// Mixed norms with p >= 1 are at most the 1-norm, so the octahedron of the semi-axes lies inside. With p >= 2 they are
// at most the 2-norm, so the ellipsoid lies inside. With a taper g(w) <= (1 + |k|) N(w) / (1 - k²) = N(w) / (1 - |k|).
PreciseInterval inner_radius(const Superquadric& solid) {
  const PreciseInterval share = PreciseInterval(1) - abs(TaperNumbers<Real>(solid.taper).k);
  if (std::ranges::max(solid.exponents) <= 1.0) return share * PreciseInterval(Real(std::ranges::min(solid.semi_axes)));
  PreciseInterval sum(0);
  for (const double a : solid.semi_axes) sum += PreciseInterval(1) / square(PreciseInterval(Real(a)));
  return share / sqrt(sum);
}

// g(q + y) <= g(q) + g(y) <= g(q) + |y| / radius, so the ball of radius (1 - g(q)) * radius about q lies inside.
double central_depth(const Superquadric& solid, const SuperquadricBounds<Real>& bounds, const PreciseVector& q) {
  const PreciseInterval depth = (PreciseInterval(1) - bounds.gauge(q)) * inner_radius(solid);
  return std::max(0.0, depth.lower().to_double(Direction::down));
}

bool contains_ball(const Superquadric& solid, const SuperquadricBounds<Real>& bounds, const PreciseVector& q,
                   double radius, const Hook& interrupted) {
  if (!(bounds.gauge(q).upper() <= Real(1)) || !std::isfinite(radius)) return false;
  if (radius <= central_depth(solid, bounds, q)) return true;
  return BallProof(revolved(solid, q), radius).succeeds(interrupted);
}

namespace {

const PreciseInterval kOne(1);
const PreciseInterval kTwo(2);

/// The share of a part in a norm, in [0, 1]; up to 1 if the norm may be 0.
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

/// Upper bounds of a term (share)^(p-2) e², and of its product with (the other share)^p.
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

/// The larger of two terms with their scales, raised by `excess` times (m - w)² or (u - v)² with their weights. These
/// squares with their weights are at most the terms themselves, or the given multiples of the mixed terms.
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
  // Both bounds stay right with any smaller number in place of the stretch.
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
