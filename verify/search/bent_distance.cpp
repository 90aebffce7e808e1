/// Proposes the nearest point by projected steps in binary64 and Newton's method in long double, else by steps in long
/// double alone, and proves it in 127-bit intervals.
#include "verify/search/bent_distance.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "verify/numbers/functions.hpp"
#include "verify/numbers/norms.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verify/search/certified_distance.hpp"
#include "verify/search/contact.hpp"
#include "verify/search/set_tree.hpp"
#include "verify/solids/bend.hpp"

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

  /// The minimiser of f over K, to about `precision` times its size; the direction is zero where the query seems to lie
  /// inside.
  [[nodiscard]] BentDistance::Candidate solution(long double precision) const {
    constexpr int most_steps = 100;
    const long double size = std::ranges::max(solid_.semi_axes);
    const ClosestInSolid closest = precision < of_binary64 ? fast_contact : rough_contact;
    Contact x = nearest_in_solid(unbent_query_, 1.0L, closest);
    for (int step = 0; step < most_steps; ++step) {
      const Contact next = newton_step(x.point, closest);
      const Proposal& a = x.point;
      const Proposal& b = next.point;
      const long double change = std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
      if (!std::isfinite(change)) break;  // out of range
      x = next;
      if (change <= precision * size) break;
    }
    return {turned_back(x.point), turned_back(towards(x))};
  }

  /// Newton's method on ∇f = λ ∇g, g = 1 from `start`, in long double: it adds digits that the steps above lack.
  /// Returns `start` if it leads away.
  [[nodiscard]] BentDistance::Candidate refined(const BentDistance::Candidate& start) const {
    constexpr int steps = 4;
    const auto gauge = NormFunction<long double>::gauge(solid_);
    const Vector focus(0, 0, focus_);
    const Vector first(start.point[0], start.point[1], start.point[2]);
    Vector x = first;
    NormExpansion<long double> g = gauge(x - focus);
    long double multiplier = -gradient(x).norm() / g.gradient.norm();
    for (int i = 0; i < steps; ++i) {
      Eigen::Matrix<long double, 4, 1> value;
      value << gradient(x) - g.gradient * multiplier, g.value - 1.0L;
      Eigen::Matrix<long double, 4, 4> jacobian = Eigen::Matrix<long double, 4, 4>::Zero();
      jacobian.topLeftCorner<3, 3>() = hessian(x) - g.hessian * multiplier;
      jacobian.topRightCorner<3, 1>() = -g.gradient;
      jacobian.bottomLeftCorner<1, 3>() = g.gradient.transpose();
      const Eigen::Matrix<long double, 4, 1> step = jacobian.partialPivLu().solve(value);
      x -= step.head<3>();
      multiplier -= step[3];
      g = gauge(x - focus);
    }
    const Contact found{turned({x[0], x[1], x[2]}), turned({g.gradient[0], g.gradient[1], g.gradient[2]})};
    constexpr long double nearby = 1e-3L;
    const bool near = (x - first).norm() <= nearby * std::ranges::max(solid_.semi_axes);
    if (!near || !usable(found.normal)) return start;
    return {{x[0], x[1], x[2]}, turned_back(towards(found))};
  }

 private:
  using Vector = Eigen::Matrix<long double, 3, 1>;
  using Matrix = Eigen::Matrix<long double, 3, 3>;
  using ClosestInSolid = Contact (*)(const Superquadric&, const Proposal&);

  static constexpr long double of_binary64 = 0x1p-30L;  // from here on steps in binary64 are as good

  /// (r, s, z) of a point of the primitive's own frame.
  [[nodiscard]] Matrix turn() const {
    Matrix result = Matrix::Identity();
    result.topLeftCorner<2, 2>() << cosine_, sine_, -sine_, cosine_;
    return result;
  }

  /// Half the gradient of f, in the primitive's own frame. With r_q, z_q of the query: no cancellation for small k.
  [[nodiscard]] Vector gradient(const Vector& x) const {
    const Vector t = turn() * x;
    const auto& [r, s, z] = unbent_query_;
    const long double turn_of = k_ * (t[2] - z);
    const long double chord = (t[2] - z) * sine_quotient_of(turn_of / 2);
    const long double w = 1 - k_ * t[0];
    const long double w_q = 1 - k_ * r;
    return turn().transpose() *
           Vector(t[0] - r - k_ * w_q * chord * chord / 2, t[1] - s, w * w_q * (t[2] - z) * sine_quotient_of(turn_of));
  }

  [[nodiscard]] Matrix hessian(const Vector& x) const {
    const Vector t = turn() * x;
    const long double turn_of = k_ * (t[2] - unbent_query_[2]);
    const long double w_q = 1 - k_ * unbent_query_[0];
    Matrix h = Matrix::Identity();
    h(0, 2) = h(2, 0) = -w_q * std::sin(turn_of);
    h(2, 2) = (1 - k_ * t[0]) * w_q * std::cos(turn_of);
    return turn().transpose() * h * turn();
  }

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

  /// The minimiser over K of a quadratic model of f. The model touches f in x and, by its diagonal Hessian, lies above
  /// it nearby. Half the Hessian of f is
  ///     1          0   -W_q sin δ
  ///     0          1    0
  ///    -W_q sin δ  0    W W_q cos δ
  /// and at most 1 + |W_q sin δ| / sqrt(W W_q cos δ) times its diagonal.
  [[nodiscard]] Contact newton_step(const Proposal& x, ClosestInSolid closest) const {
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
    // If f is not convex, some positive number serves.
    const long double metric = std::max({w * along, 0.25L * w * std::hypot(along, across), 1e-6L});
    const long double step = 1 / (1 + std::fabs(across) / std::sqrt(metric));
    return nearest_in_solid({x[0] - step * gradient[0], x[1] - step * gradient[1], x[2] - step * gradient[2] / metric},
                            metric, closest);
  }

  /// The point of K nearest to t where z counts sqrt(metric) times: the stretched solid is a superquadric as well. The
  /// normal is one of K; zero for t in K.
  [[nodiscard]] Contact nearest_in_solid(const Proposal& t, long double metric, ClosestInSolid closest) const {
    Superquadric stretched = solid_;
    stretched.semi_axes[2] = static_cast<double>(solid_.semi_axes[2] * std::sqrt(metric));
    const long double stretch = stretched.semi_axes[2] / static_cast<long double>(solid_.semi_axes[2]);
    Proposal own = turned_back(t);
    own[2] = (own[2] - focus_) * stretch;
    const Boundary<long double> boundary(stretched);
    const bool outside = boundary.gauge({std::fabs(own[0]), std::fabs(own[1]), own[2]}) > 1.0L;
    auto [point, normal] = outside ? closest(stretched, own) : Contact{own, {}};
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
  Proposal unbent_query_;  ///< r, s, z
};

// Newton's method makes up for a rough start, as a rule.
constexpr long double rough_precision = 0x1p-12L;

/// Returns whether the width is at the limit of binary64 for a distance to a solid of that size.
bool is_tight(const Enclosure& distance, double size) {
  return distance.width() <= 1e-14 * distance.hi + 1e-16 * size;
}

bool is_finite(const Proposal& x) {
  return std::ranges::all_of(x, [](long double c) { return std::isfinite(c); });
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
      radius_(length<Real>(bent_box(bend_, superquadric_))),
      proof_(primitive) {}

double BentDistance::lower_by_sphere(const Point& x) const {
  return (length<Real>(motion_.local_point(x)) - radius_.upper()).lower().to_double(Direction::down);
}

BentDistance::Query BentDistance::query(const Point& x) const {
  const PreciseVector bent = motion_.local_point(x);
  return {bent, map_.unbent(bent)};
}

BentDistance::Candidate BentDistance::proposed(const Query& q, long double precision) const {
  return ConvexProblem(superquadric_, bend_, midpoint(q.bent), midpoint(q.unbent)).solution(precision);
}

BentDistance::Candidate BentDistance::refined(const Query& q, const Candidate& start) const {
  return ConvexProblem(superquadric_, bend_, midpoint(q.bent), midpoint(q.unbent)).refined(start);
}

BentDistance::Nearest BentDistance::operator()(const Point& x) const {
  const Query q = query(x);
  const Candidate start = proposed(q, rough_precision);
  const Candidate candidate = refined(q, start);
  const Nearest fast = proven(q, candidate);
  if (is_tight(fast.distance, std::ranges::max(superquadric_.semi_axes))) return fast;
  // More digits of the nearest point do not make f convex.
  if (usable(start.direction) && !is_convex_about(q, start) && !is_convex_about(q, candidate)) return fast;
  const Nearest thorough = proven(q, proposed(q));
  const bool certain = thorough.distance.lo > 0.0;  // else the fast one's bound is of another place, and loose
  return certain && fast.distance.width() < thorough.distance.width() ? fast : thorough;
}

BentDistance::Nearest BentDistance::proven(const Point& x, const Candidate& candidate) const {
  return proven(query(x), candidate);
}

BentDistance::Foot BentDistance::foot(const Point& x) const {
  const Query q = query(x);
  const auto of_candidate = [&](const Candidate& candidate) {
    const Enclosure distance = proven(q, candidate).distance;
    const auto& d = candidate.direction;
    const long double scale = -distance.hi / std::hypot(d[0], d[1], d[2]);
    const Proposal normal{scale * d[0], scale * d[1], scale * d[2]};
    return Foot{distance, is_finite(normal) ? normal : Proposal{}};
  };
  const Foot fast = of_candidate(refined(q, proposed(q, rough_precision)));
  if (is_tight(fast.distance, std::ranges::max(superquadric_.semi_axes))) return fast;
  const Foot thorough = of_candidate(proposed(q));
  return fast.distance.lo > thorough.distance.lo ? fast : thorough;
}

Proposal BentDistance::way(const Point& from, const Point& x) const {
  return midpoint(PreciseVector(motion_.local_point(x) - motion_.local_point(from)));
}

/// The image of the candidate's point, moved into K if it may lie outside.
PreciseVector BentDistance::image_of(const Candidate& candidate) const {
  return map_.bent(in_solid(is_finite(candidate.point) ? candidate.point : Proposal{}));
}

bool BentDistance::is_convex_about(const Query& q, const Candidate& candidate) const {
  const Real upper = length<Real>(PreciseVector(image_of(candidate) - q.bent)).upper();
  return tangent_plane(q, upper, candidate.direction).has_value();
}

BentDistance::Nearest BentDistance::proven(const Query& q, const Candidate& candidate) const {
  const PreciseVector image = image_of(candidate);
  const Real upper = length<Real>(PreciseVector(image - q.bent)).upper();
  const std::optional<TangentPlane> plane = tangent_plane(q, upper, candidate.direction);
  const Real lower = plane ? plane->distance_lower : Real(0);
  const Proposal nearest = midpoint(PreciseVector(motion_.rotation * image + motion_.translation));
  return {{lower.to_double(Direction::down), upper.to_double(Direction::up)}, rounded(nearest)};
}

std::optional<ClosestSurfacePoint> BentDistance::closest_point(const Point& x) const {
  const Query q = query(x);
  const Candidate rough = proposed(q);
  std::optional<Neighbourhood> best;
  for (const Candidate& candidate : {refined(q, rough), rough}) {
    const std::optional<Neighbourhood> found = neighbourhood(q, candidate);
    if (found && (!best || found->reach < best->reach)) best = found;
  }
  return closest_in(q, best);
}

std::optional<ClosestSurfacePoint> BentDistance::closest_point(const Point& x, const Candidate& candidate) const {
  const Query q = query(x);
  return closest_in(q, neighbourhood(q, candidate));
}

std::optional<ClosestSurfacePoint> BentDistance::closest_in(const Query& q,
                                                            const std::optional<Neighbourhood>& found) const {
  if (!found) return std::nullopt;
  const PreciseVector places = inflated(found->plane.x0, found->reach);
  const PreciseInterval distance(found->plane.distance_lower, found->upper);
  const PreciseVector point = map_.bent(places);
  const PreciseInterval component(-1, 1);
  const PreciseVector normal = motion_.rotation * PreciseVector((q.bent - point) / distance);
  const std::optional<PosedBent::Rise> of_all = proof_.rise(q.unbent, places, found->upper);
  return ClosestSurfacePoint{distance, motion_(point),
                             intersection(normal, {component, component, component}, "a component of a unit normal"),
                             of_all && of_all->margin > Real(0)};
}

/// Nothing if q is not proven to lie outside, or its nearest points are not proven to lie beside x0.
std::optional<BentDistance::Neighbourhood> BentDistance::neighbourhood(const Query& q,
                                                                       const Candidate& candidate) const {
  const Real upper = length<Real>(PreciseVector(image_of(candidate) - q.bent)).upper();
  const std::optional<TangentPlane> plane = tangent_plane(q, upper, candidate.direction);
  if (!plane || !(plane->distance_lower > Real(0))) return std::nullopt;
  const std::optional<Real> reach = this->reach(q, *plane, upper);
  if (!reach) return std::nullopt;
  return Neighbourhood{*plane, upper, *reach};
}

bool BentDistance::excludes(const PreciseVector& box) const {
  const PreciseVector local = motion_.rotation.transpose() * (box - motion_.translation);
  return bounds_.gauge(map_.unbent(local) - focus_).lower() > Real(1);
}

/// Divided by its gauge where that may exceed 1.
PreciseVector BentDistance::in_solid(const Proposal& point) const {
  const PreciseVector x = precise(point);
  const PreciseVector from_focus = x - focus_;
  const PreciseInterval gauge(bounds_.gauge_up(from_focus));
  return gauge.upper() > Real(1) ? PreciseVector(focus_ + from_focus / gauge) : x;
}

/// The tangent plane with p - q along `direction` and as long as `upper`, which is a proven bound of d(q, β(K)).
/// Nothing if f is not proven to lie above it.
std::optional<BentDistance::TangentPlane> BentDistance::tangent_plane(const Query& q, const Real& upper,
                                                                      const Proposal& direction) const {
  if (!usable(direction)) return std::nullopt;
  const long double scale = upper.to_long_double() / std::hypot(direction[0], direction[1], direction[2]);
  const Proposal scaled{scale * direction[0], scale * direction[1], scale * direction[2]};
  if (!is_finite(scaled)) return std::nullopt;
  const PreciseVector apart = precise(scaled);
  const PreciseVector x0 = map_.unbent(q.bent + apart);
  const PreciseVector from_focus = x0 - focus_;
  const PreciseInterval squared = squared_length(apart);
  if (!proof_.rise(q.unbent, x0, std::max(upper, sqrt(squared).upper()))) return std::nullopt;
  const PreciseVector v = map_.pulled_back(apart, x0);
  const PreciseInterval loss = PreciseInterval(2) * (bounds_.support(-v) + v.dot(from_focus));
  return TangentPlane{x0, sqrt(PreciseInterval(std::max((squared - loss).lower(), Real(0)))).lower()};
}

/// An upper bound of |x - x0| in every coordinate for all x of K whose image is as near as `upper`; the nearest are
/// among them (docs/mathematics.md §25). f rises above the plane by no more than η = U² - lo² at these x, so that
///     |s - s0| <= √η,   |z - z0| sin(δ/2)/(δ/2) <= √(η/(W_q C)),   |r - r0| <= √η + W_q |z - z0|.
/// Nothing if the margin C is 0, or the turn too large.
std::optional<Real> BentDistance::reach(const Query& q, const TangentPlane& plane, const Real& upper) const {
  const std::optional<PosedBent::Rise> above = proof_.rise(q.unbent, plane.x0, upper);
  if (!above || !(above->margin > Real(0))) return std::nullopt;
  const PreciseInterval two(2);
  const PreciseInterval w_q = PreciseInterval(1) - PreciseInterval(Real(bend_.curvature)) * map_.turned(q.unbent)[0];
  const PreciseInterval half_turn = PreciseInterval(above->turn) / two;
  if (!(half_turn.upper() < (pi<Real>() / two).lower() && w_q.lower() > Real(0))) return std::nullopt;
  const PreciseInterval lo(plane.distance_lower);
  const PreciseInterval hi(upper);
  const PreciseInterval left = sqrt(PreciseInterval(std::max(Real(0), ((hi - lo) * (hi + lo)).upper())));
  // The quotient falls with |δ|.
  const PreciseInterval least_quotient = sine_quotient(half_turn);
  const PreciseInterval height = left / sqrt(w_q * PreciseInterval(above->margin)) / least_quotient;
  // x and y are r and s, turned: none leaves its place by more than both together.
  return std::max(height.upper(), (two * left + w_q * height).upper());
}

}  // namespace verisq::verify
