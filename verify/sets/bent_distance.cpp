/// Proposes the nearest point by projected Newton steps in long double, and proves it in 127-bit intervals.
#include "verify/sets/bent_distance.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "verify/analysis/trigonometry.hpp"
#include "verify/proof/boundary.hpp"
#include "verify/search/contact.hpp"
#include "verify/sets/bend_range.hpp"

namespace verisq::verify {

namespace {

/// x0 may lie outside of K: within 1 + this times K, about its focus.
constexpr double kNeighbourhood = 0x1p-20;
/// What (1 + kNeighbourhood) K extends from the axis and along it is at most 1 + this times what K does: about a focus
/// |k| a3 from the centre, that is (1 + kNeighbourhood (1 + |k|)) a3 along the axis.
constexpr double kWidening = 2 * kNeighbourhood;

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

/// |k| (1 + kWidening): what the curvature is to the scaled solid.
PreciseInterval scaled_curvature(const Bend& bend) {
  return abs(PreciseInterval(Real(bend.curvature))) * PreciseInterval(Real(1.0 + kWidening));
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
      least_w_(PreciseInterval(1) - scaled_curvature(bend_) * extent(bend_, superquadric_)),
      angle_(scaled_curvature(bend_) * PreciseInterval(Real(superquadric_.semi_axes[2]))),
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
  const bool near = bounds_.gauge(from_focus).upper() <= Real(1.0 + kNeighbourhood);
  if (!near || !is_convex(q, std::max(upper, sqrt(squared).upper()))) return 0;
  const PreciseVector v = map_.pulled_back(apart, x0);
  const PreciseInterval loss = PreciseInterval(2) * (bounds_.support(-v) + v.dot(from_focus));
  return sqrt(PreciseInterval(std::max((squared - loss).lower(), Real(0)))).lower();
}

/// The condition on K' = {x in (1 + kNeighbourhood) K : W >= least_w, |sin δ| <= sine, cos δ > 0}, which is convex
/// because δ is linear and stays within three quarters of a turn: it lies in one interval between its zero and a
/// quarter to either side. There W cos δ - W_q sin² δ is at least what it is for the least W and the largest sine.
bool BentDistance::is_convex(const Query& q, const Real& upper) const {
  const PreciseVector turned = map_.turned(q.unbent);
  const PreciseInterval k = Real(bend_.curvature);
  const PreciseInterval w = PreciseInterval(1) - k * turned[0];
  const PreciseInterval reach = abs(k) * PreciseInterval(upper);
  const PreciseInterval largest_angle((angle_ + abs(k * turned[2])).upper());
  const PreciseInterval quarter = pi<Real>() / PreciseInterval(2);

  Real sine(1);
  if (largest_angle.upper() < quarter.lower()) sine = sin(largest_angle).upper();  // of all of that
  if (reach.upper() < w.lower() && largest_angle.upper() < (PreciseInterval(3) * quarter).lower()) {
    sine = std::min(sine, (reach / w).upper());
  }
  const PreciseInterval least_w(std::max(least_w_.lower(), (w - reach).lower()));
  if (!(sine < Real(1)) || !(least_w.lower() > Real(0))) return false;
  const PreciseInterval squared_sine = square(PreciseInterval(sine));
  return (least_w * sqrt(PreciseInterval(1) - squared_sine) - w * squared_sine).lower() >= Real(0);
}

}  // namespace verisq::verify
