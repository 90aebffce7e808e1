/// Proposes the nearest point by projected Newton steps in long double, and proves it in 127-bit intervals.
#include "verify/sets/bent_distance.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "verify/analysis/trigonometry.hpp"
#include "verify/proof/boundary.hpp"
#include "verify/search/contact.hpp"
#include "verify/sets/bend_range.hpp"

namespace verisq::verify {

namespace {

/// f and K in plain floating point, in the frame of the bend (docs/mathematics.md §9): unbent (r, s, z), bent (R, S,
/// Z).
class ConvexProblem {
 public:
  /// Everything in the primitive's own motion.
  ConvexProblem(const Superquadric& solid, const Bend& bend, const Proposal& query, const Proposal& unbent_query)
      : solid_(solid),
        focus_(midpoint(focus(solid))[2]),
        k_(bend.curvature),
        cosine_(std::cos(bend.angle_degrees * std::numbers::pi_v<long double> / 180)),
        sine_(std::sin(bend.angle_degrees * std::numbers::pi_v<long double> / 180)),
        query_(turned(query)),
        unbent_query_(turned(unbent_query)) {}

  /// The minimiser of f over K; the direction is zero where the query seems to lie inside.
  [[nodiscard]] BentDistance::Candidate solution() const {
    constexpr int most_steps = 100;
    const long double size = std::ranges::max(solid_.semi_axes);
    Contact x = nearest_in_solid(unbent_query_, 1.0L);
    for (int step = 0; step < most_steps; ++step) {
      const Contact next = newton_step(x.point);
      const Proposal& a = x.point;
      const Proposal& b = next.point;
      const long double change = std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
      if (!std::isfinite(change)) break;  // out of range
      x = next;
      if (change <= 0x1p-60L * size) break;
    }
    return {turned_back(x.point), turned_back(towards(x))};
  }

 private:
  [[nodiscard]] Proposal turned(const Proposal& v) const {
    return {v[0] * cosine_ + v[1] * sine_, v[1] * cosine_ - v[0] * sine_, v[2]};
  }
  [[nodiscard]] Proposal turned_back(const Proposal& v) const {
    return {v[0] * cosine_ - v[1] * sine_, v[0] * sine_ + v[1] * cosine_, v[2]};
  }

  static long double sine_quotient_of(long double angle) { return angle == 0.0L ? 1.0L : std::sin(angle) / angle; }

  [[nodiscard]] Proposal bent(const Proposal& x) const {
    const long double angle = k_ * x[2];
    const long double sagitta = x[2] * std::sin(angle / 2) * sine_quotient_of(angle / 2);
    return {x[0] * std::cos(angle) + sagitta, x[1], (1 - k_ * x[0]) * x[2] * sine_quotient_of(angle)};
  }

  /// The minimiser over K of a quadratic model of f that touches it in x and, by its diagonal Hessian, lies above it
  /// nearby. Half the Hessian of f is
  ///     1          0   -W_q sin δ
  ///     0          1    0
  ///    -W_q sin δ  0    W W_q cos δ
  /// and at most 1 + |W_q sin δ| / sqrt(W W_q cos δ) times its diagonal.
  [[nodiscard]] Contact newton_step(const Proposal& x) const {
    const long double angle = k_ * x[2];
    const long double c = std::cos(angle);
    const long double n = std::sin(angle);
    const long double w = 1 - k_ * x[0];
    const Proposal y = bent(x);
    const Proposal apart{y[0] - query_[0], y[1] - query_[1], y[2] - query_[2]};
    const Proposal gradient{c * apart[0] - n * apart[2], apart[1], w * (n * apart[0] + c * apart[2])};
    // k W_q sin δ and W_q cos δ, from the query relative to the centre of curvature.
    const long double m = 1 - k_ * query_[0];
    const long double rise = k_ * query_[2];
    const long double along = m * c + rise * n;
    const long double across = m * n - rise * c;
    // Where f is not convex, some positive number does.
    const long double metric = std::max({w * along, 0.25L * w * std::hypot(along, across), 1e-6L});
    const long double step = 1 / (1 + std::fabs(across) / std::sqrt(metric));
    return nearest_in_solid({x[0] - step * gradient[0], x[1] - step * gradient[1], x[2] - step * gradient[2] / metric},
                            metric);
  }

  /// The point of K nearest to t where z counts sqrt(metric) times: the stretched solid is a superquadric as well. The
  /// normal is one of K; zero for t in K.
  [[nodiscard]] Contact nearest_in_solid(const Proposal& t, long double metric) const {
    Superquadric stretched = solid_;
    stretched.semi_axes[2] = static_cast<double>(solid_.semi_axes[2] * std::sqrt(metric));
    const long double stretch = stretched.semi_axes[2] / static_cast<long double>(solid_.semi_axes[2]);
    Proposal own = turned_back(t);
    own[2] = (own[2] - focus_) * stretch;
    const Boundary<long double> boundary(stretched);
    const bool outside = boundary.gauge({std::fabs(own[0]), std::fabs(own[1]), own[2]}) > 1.0L;
    auto [point, normal] = outside ? fast_contact(stretched, own) : Contact{own, {}};
    point[2] = point[2] / stretch + focus_;
    normal[2] *= stretch;
    return {turned(point), turned(normal)};
  }

  /// The d with β'(x)ᵀ d = -normal, that of the nearest point x.
  [[nodiscard]] Proposal towards(const Contact& x) const {
    const long double c = std::cos(k_ * x.point[2]);
    const long double n = std::sin(k_ * x.point[2]);
    const long double along_axis = x.normal[2] / (1 - k_ * x.point[0]);
    return {-(c * x.normal[0] + n * along_axis), -x.normal[1], n * x.normal[0] - c * along_axis};
  }

  Superquadric solid_;
  long double focus_;  ///< along z from the centre
  long double k_;
  long double cosine_, sine_;
  Proposal query_;
  Proposal unbent_query_;
};

bool is_finite(const Proposal& x) {
  return std::ranges::all_of(x, [](long double c) { return std::isfinite(c); });
}

/// Upper bound of φ(δ) = (δ - sin δ) / (1 - cos δ) for δ in [0, turn], in which it rises: there δ - sin δ <= δ³/6 and
/// 1 - cos δ >= δ²/2 - δ⁴/24. Nothing where turn² >= 12.
std::optional<Real> turn_quotient_up(const Real& turn) {
  const PreciseInterval t(turn);
  const PreciseInterval fall = PreciseInterval(1) - square(t) / PreciseInterval(12);
  if (!(fall.lower() > Real(0))) return std::nullopt;
  return (t / (PreciseInterval(3) * fall)).upper();
}

/// Upper bound of sin² of all angles up to `angle` >= 0.
Real squared_sine_up(const Real& angle) {
  const PreciseInterval quarter = pi<Real>() / PreciseInterval(2);
  return angle < quarter.lower() ? square(sin(PreciseInterval(angle))).upper() : Real(1);
}

PreciseInterval squared_length(const PreciseVector& v) {
  return square(v[0]) + square(v[1]) + square(v[2]);
}

}  // namespace

BentDistance::BentDistance(const Primitive& primitive)
    : superquadric_(primitive.superquadric),
      bend_(*primitive.bend),
      bounds_(primitive.superquadric),
      focus_(focus(primitive.superquadric)),
      motion_(primitive.pose),
      map_(bend_),
      angle_(abs(PreciseInterval(Real(bend_.curvature))) * PreciseInterval(Real(superquadric_.semi_axes[2]))),
      radius_(length<Real>(bent_box(bend_, superquadric_))) {}

double BentDistance::lower_by_sphere(const Point& x) const {
  return (length<Real>(motion_.local_point(x)) - radius_.upper()).lower().to_double(Direction::down);
}

BentDistance::Query BentDistance::query(const Point& x) const {
  const PreciseVector bent = motion_.local_point(x);
  return {bent, map_.unbent(bent)};
}

BentDistance::Nearest BentDistance::operator()(const Point& x) const {
  const Query q = query(x);
  return proven(q, ConvexProblem(superquadric_, bend_, midpoint(q.bent), midpoint(q.unbent)).solution());
}

BentDistance::Nearest BentDistance::proven(const Point& x, const Candidate& candidate) const {
  return proven(query(x), candidate);
}

BentDistance::Nearest BentDistance::proven(const Query& q, const Candidate& candidate) const {
  const PreciseVector image = map_.bent(in_solid(is_finite(candidate.point) ? candidate.point : Proposal{}));
  const Real upper = length<Real>(PreciseVector(image - q.bent)).upper();
  const Real lower = lower_bound(q, upper, candidate.direction);
  const Proposal nearest = midpoint(PreciseVector(motion_.rotation * image + motion_.translation));
  return {{lower.to_double(Direction::down), upper.to_double(Direction::up)}, rounded(nearest)};
}

/// Divided by its gauge where that may exceed 1.
PreciseVector BentDistance::in_solid(const Proposal& point) const {
  const PreciseVector x = precise(point);
  const PreciseVector from_focus = x - focus_;
  const PreciseInterval gauge(bounds_.gauge_up(from_focus));
  return gauge.upper() > Real(1) ? PreciseVector(focus_ + from_focus / gauge) : x;
}

/// With p - q along `direction` and as long as `upper`, which is a proven bound of d(q, β(K)).
Real BentDistance::lower_bound(const Query& q, const Real& upper, const Proposal& direction) const {
  if (!usable(direction)) return 0;
  const long double scale = upper.to_long_double() / std::hypot(direction[0], direction[1], direction[2]);
  const Proposal scaled{scale * direction[0], scale * direction[1], scale * direction[2]};
  if (!is_finite(scaled)) return 0;
  const PreciseVector apart = precise(scaled);
  const PreciseVector x0 = map_.unbent(q.bent + apart);
  const PreciseVector from_focus = x0 - focus_;
  const PreciseInterval squared = squared_length(apart);
  if (!lies_above_tangent(q, x0, std::max(upper, sqrt(squared).upper()))) return 0;
  const PreciseVector v = map_.pulled_back(apart, x0);
  const PreciseInterval loss = PreciseInterval(2) * (bounds_.support(-v) + v.dot(from_focus));
  return sqrt(PreciseInterval(std::max((squared - loss).lower(), Real(0)))).lower();
}

/// The condition for all turns δ from x0 to a point of K. Of points within `upper` of the query, where that is nearer
/// than the centre of curvature, |sin(γ - γ_q)| <= |k| upper / W_q and the cosine is positive; with |γ - γ_q| below
/// three quarters of a turn they are within a quarter.
bool BentDistance::lies_above_tangent(const Query& q, const PreciseVector& x0, const Real& upper) const {
  const PreciseVector turned_q = map_.turned(q.unbent);
  const PreciseVector turned_0 = map_.turned(x0);
  const PreciseInterval one(1);
  const PreciseInterval two(2);
  const PreciseInterval k = Real(bend_.curvature);
  const PreciseInterval w_q = one - k * turned_q[0];
  const PreciseInterval w_0 = one - k * turned_0[0];
  const PreciseInterval gamma_q = k * turned_q[2];
  const PreciseInterval gamma_0 = k * turned_0[2];
  const PreciseInterval apart = gamma_0 - gamma_q;
  const PreciseInterval quarter = pi<Real>() / two;
  if (!(abs(apart).upper() < (two * quarter).lower())) return false;  // the sine has not the sign of the turn

  Real turn(0);  // the largest δ away from the query
  if (apart.upper() > Real(0)) turn = std::max(turn, (angle_ - gamma_0).upper());
  if (apart.lower() < Real(0)) turn = std::max(turn, (angle_ + gamma_0).upper());
  Real between = (abs(gamma_0 / two - gamma_q) + angle_ / two).upper();  // the largest |apart + δ/2|

  const PreciseInterval reach = abs(k) * PreciseInterval(upper);
  if (reach.upper() < w_q.lower() && (angle_ + abs(gamma_q)).upper() < (PreciseInterval(3) * quarter).lower()) {
    const PreciseInterval sine((reach / w_q).upper());
    const PreciseInterval cosine = sqrt(one - square(sine));
    const PreciseInterval angle = cosine.lower() > Real(0) ? atan(sine / cosine) : quarter;
    turn = std::min(turn, std::max(Real(0), (angle - abs(apart)).upper()));
    between = std::min(between, ((angle + abs(apart)) / two).upper());
  }
  const std::optional<Real> quotient = turn_quotient_up(turn);
  if (!quotient) return false;
  const PreciseInterval curving = cos(apart) - abs(sin(apart)) * PreciseInterval(*quotient);
  return curving.lower() > Real(0) &&
         (w_0 * curving).lower() >= (w_q * PreciseInterval(squared_sine_up(between))).upper();
}

}  // namespace verisq::verify
