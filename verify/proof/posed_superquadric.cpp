/// This file implements posed_superquadric.hpp, but for the balls.
#include "verify/proof/posed_superquadric.hpp"

#include <algorithm>

#include "verify/numbers/interval.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/error.hpp"

namespace verisq::verify {

namespace {

/// The box's faces are given by the support function.
PreciseVector box_about(const SuperquadricBounds<Real>& bounds) {
  const auto reach = [&](int x, int y, int z) { return bounds.support_up(PreciseVector(x, y, z)); };
  const auto between = [](const Real& below, const Real& above) { return PreciseInterval(-below, above); };
  return {between(reach(-1, 0, 0), reach(1, 0, 0)), between(reach(0, -1, 0), reach(0, 1, 0)),
          between(reach(0, 0, -1), reach(0, 0, 1))};
}

/// A mesh has no superquadric: whoever forgets to look is stopped here.
const Superquadric& superquadric_of(const Primitive& primitive) {
  if (primitive.mesh) throw Error(ErrorKind::input, "a mesh, where a superquadric is needed");
  return primitive.superquadric;
}

RigidMotion from_own_frame(const Primitive& primitive) {
  RigidMotion motion(primitive.pose);
  if (is_tapered(primitive.superquadric)) motion.translation = motion(focus(primitive.superquadric));
  return motion;
}

}  // namespace

PosedSuperquadric::PosedSuperquadric(const Primitive& primitive)
    : superquadric_(superquadric_of(primitive)),
      bounds_(primitive.superquadric),
      motion_(from_own_frame(primitive)),
      box_(box_about(bounds_)),
      radius_(length<Real>(box_).upper()) {}

double PosedSuperquadric::lower_by_sphere(const PreciseVector& x) const {
  return (length<Real>(PreciseVector(x - motion_.translation)) - radius_).lower().to_double(Direction::down);
}

double PosedSuperquadric::lower_by_normal(const Point& x, const Proposal& v) const {
  return lower_bound(bounds_, motion_.local_point(x), v);
}

double PosedSuperquadric::upper_by_normal(const Point& x, const Proposal& v) const {
  if (!usable(v)) return infinity;
  const PreciseVector q = motion_.local_point(x);
  return upper_bound_at(bounds_, q, PreciseVector(q - precise(v)));
}

bool PosedSuperquadric::contains(const PreciseVector& x) const {
  return bounds_.gauge(motion_.rotation.transpose() * (x - motion_.translation)).upper() <= Real(1);
}

bool PosedSuperquadric::contains_ball_about(const Point& x, double radius, const Proposal& /*v*/,
                                            const Hook& interrupted) const {
  return contains_ball(superquadric_, bounds_, motion_.local_point(x), radius, interrupted);
}

std::optional<OwnRegion> PosedSuperquadric::over(const PreciseVector& centre, const std::array<Real, 3>& half) const {
  const PreciseMatrix to_own = motion_.rotation.transpose();
  const PreciseVector own = to_own * (centre - motion_.translation);
  return OwnRegion{own, own + to_own * box_of(half), to_own};
}

namespace {

/// Upper bound of φ(δ) = (δ - sin δ) / (1 - cos δ) for δ in [0, turn], in which it rises: there δ - sin δ <= δ³/6 and
/// 1 - cos δ >= δ²/2 - δ⁴/24. Nothing where turn² >= 12.
std::optional<Real> turn_quotient_above(const Real& turn) {
  const PreciseInterval t(turn);
  const PreciseInterval fall = PreciseInterval(1) - square(t) / PreciseInterval(12);
  if (!(fall.lower() > Real(0))) return std::nullopt;
  return (t / (PreciseInterval(3) * fall)).upper();
}

/// Upper bound of sin² of all angles up to `angle` >= 0.
Real squared_sine_above(const Real& angle) {
  const PreciseInterval quarter = half_turn() / PreciseInterval(2);
  return angle < quarter.lower() ? square(sine_of(PreciseInterval(angle))).upper() : Real(1);
}

/// β keeps distances along the axis no longer and those across as they are: |β(r, s, z)| <= |z| + |(r, s)|.
PreciseInterval radius_of(const Superquadric& solid, const SuperquadricBounds<Real>& bounds) {
  const PreciseInterval along_x(bounds.support_up({1, 0, 0}));
  const PreciseInterval along_y(bounds.support_up({0, 1, 0}));
  return PreciseInterval(Real(solid.semi_axes[2])) + sqrt(square(along_x) + square(along_y));
}

}  // namespace

PosedBent::PosedBent(const Primitive& primitive)
    : superquadric_(primitive.superquadric),
      bounds_(primitive.superquadric),
      focus_(focus(primitive.superquadric)),
      motion_(primitive.pose),
      k_(Real(primitive.bend->curvature)),
      cosine_(cosine_of_degrees(primitive.bend->angle_degrees)),
      sine_(sine_of_degrees(primitive.bend->angle_degrees)),
      angle_(abs(k_) * PreciseInterval(Real(superquadric_.semi_axes[2]))),
      radius_(radius_of(superquadric_, bounds_)) {}

/// (x, y, z) -> (r, s, z): r along the bend.
PreciseVector PosedBent::turned(const PreciseVector& v) const {
  return {v[0] * cosine_ + v[1] * sine_, v[1] * cosine_ - v[0] * sine_, v[2]};
}

PreciseVector PosedBent::turned_back(const PreciseVector& v) const {
  return {v[0] * cosine_ - v[1] * sine_, v[0] * sine_ + v[1] * cosine_, v[2]};
}

/// R = r cos γ + z sin(γ/2) sin(γ/2)/(γ/2), Z = (1 - k r) z sin(γ)/γ with γ = k z.
PreciseVector PosedBent::bent(const PreciseVector& unbent) const {
  const PreciseVector v = turned(unbent);
  const PreciseInterval gamma = k_ * v[2];
  const PreciseInterval half = gamma / PreciseInterval(2);
  const PreciseInterval along = v[0] * cosine_of(gamma) + v[2] * sine_of(half) * quotient_of_sine(half);
  return turned_back({along, v[1], (PreciseInterval(1) - k_ * v[0]) * v[2] * quotient_of_sine(gamma)});
}

/// r = (2R - k (R² + Z²)) / (1 + W), z = 2Z/(W + m) atan(τ)/τ with m = 1 - k R, W = |(m, k Z)|, τ = k Z/(W + m).
/// Nothing if W + m may be 0: at the half plane in which the angle jumps.
std::optional<PreciseVector> PosedBent::unbent(const PreciseVector& bent) const {
  const PreciseInterval one(1);
  const PreciseInterval two(2);
  const PreciseVector v = turned(bent);
  const PreciseInterval m = one - k_ * v[0];
  const PreciseInterval rise = k_ * v[2];
  const PreciseInterval w = sqrt(square(m) + square(rise));
  const PreciseInterval sum = w + m;
  if (!(sum.lower() > Real(0))) return std::nullopt;
  const PreciseInterval r = (two * v[0] - k_ * (square(v[0]) + square(v[2]))) / (one + w);
  return turned_back({r, v[1], two * v[2] / sum * quotient_of_arctangent(rise / sum)});
}

/// β'ᵀ v: a turn by γ in the plane of the bend, that stretches z by 1 - k r.
PreciseVector PosedBent::pulled_back(const PreciseVector& v, const PreciseVector& unbent) const {
  const PreciseVector x = turned(unbent);
  const PreciseVector u = turned(v);
  const PreciseInterval c = cosine_of(k_ * x[2]);
  const PreciseInterval s = sine_of(k_ * x[2]);
  return turned_back({c * u[0] - s * u[2], u[1], (PreciseInterval(1) - k_ * x[0]) * (s * u[0] + c * u[2])});
}

/// The derivative of β⁻¹ where it has these values: β' inverted. Precondition: 1 - k r > 0.
PreciseMatrix PosedBent::unbending(const PreciseVector& unbent) const {
  const PreciseVector x = turned(unbent);
  const PreciseInterval c = cosine_of(k_ * x[2]);
  const PreciseInterval s = sine_of(k_ * x[2]);
  const PreciseInterval w = PreciseInterval(1) - k_ * x[0];
  const PreciseMatrix turn({cosine_, sine_, 0}, {-sine_, cosine_, 0}, {0, 0, 1});
  return turn.transpose() * (PreciseMatrix({c, 0, -s}, {0, 1, 0}, {s / w, 0, c / w}) * turn);
}

/// The derivative bounds the range, too (mean value theorem), which is tighter in small regions.
std::optional<OwnRegion> PosedBent::over(const PreciseVector& centre, const std::array<Real, 3>& half) const {
  const PreciseMatrix to_own = motion_.rotation.transpose();
  const PreciseVector own = to_own * (centre - motion_.translation);
  const std::optional<PreciseVector> at = unbent(own);
  const std::optional<PreciseVector> all = unbent(own + to_own * box_of(half));
  if (!at || !all || !((PreciseInterval(1) - k_ * turned(*all)[0]).lower() > Real(0))) return std::nullopt;
  OwnRegion result{*at - focus_, *all - focus_, unbending(*all) * to_own};
  const PreciseVector linear = result.centre + result.derivative * box_of(half);
  for (std::size_t i = 0; i < 3; ++i) {
    result.range[i] = {std::max(result.range[i].lower(), linear[i].lower()),
                       std::min(result.range[i].upper(), linear[i].upper())};
  }
  return result;
}

/// The bent K has |γ| <= A = |k| a3 < π, γ the angle of (m, k Z), m = 1 - k R; beyond that m sin A < |k Z| cos A.
bool PosedBent::misses(const PreciseVector& box) const {
  if (lower_by_sphere(box) > 0.0) return true;
  const PreciseVector v = turned(motion_.rotation.transpose() * (box - motion_.translation));
  const PreciseInterval beyond =
      (PreciseInterval(1) - k_ * v[0]) * sine_of(angle_) - abs(k_ * v[2]) * cosine_of(angle_);
  return angle_.upper() < half_turn().lower() && beyond.upper() < Real(0);
}

PosedBent::Query PosedBent::query(const Point& x) const {
  const PreciseVector own = motion_.local_point(x);
  return {own, unbent(own)};
}

/// |q - β(b)|, b the point of K's surface on the ray from the focus through x0.
std::optional<Real> PosedBent::upper(const Query& q, const PreciseVector& x0) const {
  const PreciseVector from_focus = x0 - focus_;
  const Real gauge = bounds_.gauge_up(from_focus);
  if (!(gauge < Real(infinity))) return std::nullopt;
  const PreciseVector b = gauge > Real(0) ? PreciseVector(focus_ + from_focus / PreciseInterval(gauge)) : focus_;
  return length<Real>(PreciseVector(q.bent - bent(b))).upper();
}

double PosedBent::lower_by_sphere(const PreciseVector& x) const {
  return (length<Real>(PreciseVector(x - motion_.translation)) - radius_).lower().to_double(Direction::down);
}

Enclosure PosedBent::by_normal(const Point& x, const Proposal& v) const {
  const Enclosure nothing{-infinity, infinity};
  if (!usable(v)) return nothing;
  const Query q = query(x);
  const PreciseVector apart = -precise(v);
  const std::optional<PreciseVector> x0 = unbent(q.bent + apart);
  const std::optional<Real> above = x0 ? upper(q, *x0) : std::nullopt;
  if (!above) return nothing;
  const Enclosure proven_above{-infinity, above->to_double(Direction::up)};
  const PreciseInterval size = length<Real>(apart);
  if (!q.unbent || !rise(*q.unbent, *x0, std::max(*above, size.upper()))) return proven_above;
  const PreciseVector w = pulled_back(apart, *x0);
  const PreciseInterval loss =
      PreciseInterval(2) * (PreciseInterval(bounds_.support_up(-w)) + w.dot(PreciseVector(*x0 - focus_)));
  const Real squared = (square(size) - loss).lower();
  if (!(squared > Real(0))) return proven_above;
  return {square_root(squared, Direction::down).to_double(Direction::down), proven_above.hi};
}

double PosedBent::upper_by_normal(const Point& x, const Proposal& v) const {
  if (!usable(v)) return infinity;
  const Query q = query(x);
  const std::optional<PreciseVector> x0 = unbent(q.bent - precise(v));
  const std::optional<Real> above = x0 ? upper(q, *x0) : std::nullopt;
  return above ? above->to_double(Direction::up) : infinity;
}

bool PosedBent::contains(const Point& x) const {
  const std::optional<PreciseVector> own = query(x).unbent;
  return own && bounds_.gauge_up(*own - focus_) <= Real(1);
}

/// For points within `upper` of the query, if that is nearer than the centre of curvature, |sin(γ - γ_q)| <= |k| upper
/// / W_q and the cosine is positive. With |γ - γ_q| below three quarters of a turn they are within a quarter.
std::optional<PosedBent::Rise> PosedBent::rise(const PreciseVector& unbent_query, const PreciseVector& x0,
                                               const Real& upper) const {
  const PreciseVector turned_q = turned(unbent_query);
  const PreciseVector turned_0 = turned(x0);
  const PreciseInterval one(1);
  const PreciseInterval two(2);
  const PreciseInterval w_q = one - k_ * turned_q[0];
  const PreciseInterval w_0 = one - k_ * turned_0[0];
  const PreciseInterval gamma_q = k_ * turned_q[2];
  const PreciseInterval gamma_0 = k_ * turned_0[2];
  const PreciseInterval apart = gamma_0 - gamma_q;
  const PreciseInterval quarter = half_turn() / two;
  if (!(abs(apart).upper() < (two * quarter).lower())) return std::nullopt;  // the sine has not the sign of the turn

  Real turn(0);  // the largest δ away from the query
  if (apart.upper() > Real(0)) turn = std::max(turn, (angle_ - gamma_0).upper());
  if (apart.lower() < Real(0)) turn = std::max(turn, (angle_ + gamma_0).upper());
  Real between = (abs(gamma_0 / two - gamma_q) + angle_ / two).upper();  // the largest |apart + δ/2|
  Real any_turn = (angle_ + abs(gamma_0)).upper();

  const PreciseInterval reach = abs(k_) * PreciseInterval(upper);
  if (reach.upper() < w_q.lower() && (angle_ + abs(gamma_q)).upper() < (PreciseInterval(3) * quarter).lower()) {
    const PreciseInterval sine((reach / w_q).upper());
    const PreciseInterval cosine = sqrt(one - square(sine));
    const PreciseInterval angle = cosine.lower() > Real(0) ? arctangent_of(sine / cosine) : quarter;
    turn = std::min(turn, std::max(Real(0), (angle - abs(apart)).upper()));
    between = std::min(between, ((angle + abs(apart)) / two).upper());
    any_turn = std::min(any_turn, (angle + abs(apart)).upper());
  }
  const std::optional<Real> quotient = turn_quotient_above(turn);
  if (!quotient) return std::nullopt;
  const PreciseInterval curving = cosine_of(apart) - abs(sine_of(apart)) * PreciseInterval(*quotient);
  if (!(curving.lower() > Real(0))) return std::nullopt;
  const Real margin = (w_0 * curving - w_q * PreciseInterval(squared_sine_above(between))).lower();
  if (!(margin >= Real(0))) return std::nullopt;
  return Rise{margin, any_turn};
}

bool PosedBent::contains_ball_about(const Point& x, double radius, const Proposal& v, const Hook& /*one look*/) const {
  if (!usable(v) || !(radius > 0.0)) return false;
  const Query q = query(x);
  const PreciseVector way = -precise(v);
  // The point of the boundary of a ball at least as large: way times one exact number.
  const PreciseVector apart = way * PreciseInterval((PreciseInterval(Real(radius)) / length<Real>(way)).upper());
  const std::optional<PreciseVector> touching = unbent(q.bent + apart);
  if (!q.unbent || !touching) return false;
  const PreciseInterval one(1);
  return is_bent_ball_contained(superquadric_, abs(k_),
                                {.radius = length<Real>(apart),
                                 .query = *q.unbent,
                                 .query_stretch = one - k_ * turned(*q.unbent)[0],
                                 .touching = *touching,
                                 .touching_stretch = one - k_ * turned(*touching)[0],
                                 .normal = pulled_back(apart, *touching)});
}

namespace {

/// min_i v·t_i, rounded down.
PreciseInterval least_along(const PreciseVector& v, const std::array<PreciseVector, 3>& corners) {
  const auto along_v = [&](std::size_t i) { return v.dot(corners[i]).lower(); };
  return PreciseInterval(std::min({along_v(0), along_v(1), along_v(2)}));
}

}  // namespace

bool in_triangle(const Weights& weights) {
  // The sum rounded up is above 1 exactly if the sum is, because 1 is a number of 127 bits.
  return weights[0] >= 0.0 && weights[1] >= 0.0 && add(Real(weights[0]), Real(weights[1]), Direction::up) <= Real(1);
}

PreciseVector point_of(const std::array<PreciseVector, 3>& corners, const Weights& weights) {
  const PreciseVector first = corners[1] - corners[0];
  const PreciseVector second = corners[2] - corners[0];
  return corners[0] + first * PreciseInterval(Real(weights[0])) + second * PreciseInterval(Real(weights[1]));
}

PosedTriangle::PosedTriangle(const Triangle& triangle, const RigidMotion& motion)
    : corners_{motion.local_point(triangle[0]), motion.local_point(triangle[1]), motion.local_point(triangle[2])} {}

double lower_by_sphere(const PreciseVector& centre, const PreciseInterval& radius, const Triangle& triangle) {
  std::array<PreciseVector, 3> from_centre;  // distances to the centre need no rotation
  for (std::size_t i = 0; i < 3; ++i) {
    from_centre[i] = precise(triangle[i]) - centre;
  }
  const Proposal u =
      proposed::closest_to_origin({midpoint(from_centre[0]), midpoint(from_centre[1]), midpoint(from_centre[2])});
  if (!usable(u)) return (-radius).lower().to_double(Direction::down);
  const PreciseVector direction = precise(u);
  const PreciseInterval distance = least_along(direction, from_centre) / length<Real>(direction);
  return (distance - radius).lower().to_double(Direction::down);
}

double lower_by_normal(const PosedSuperquadric& solid, const PosedTriangle& triangle, const Proposal& v) {
  if (!usable(v)) return -infinity;
  const PreciseVector direction = precise(v);
  const PreciseInterval support(solid.bounds().support_up(direction));
  const PreciseInterval bound = (least_along(direction, triangle.corners()) - support) / length<Real>(direction);
  return bound.lower().to_double(Direction::down);
}

double lower_by_normal(const PosedPrimitive& primitive, const Triangle& triangle, const Proposal& v) {
  const auto* const solid = std::get_if<PosedSuperquadric>(&primitive);
  return solid != nullptr ? lower_by_normal(*solid, PosedTriangle(triangle, solid->motion()), v) : -infinity;
}

double lower_by_normal(const PosedPrimitive& primitive, const Point& x, const Proposal& v) {
  return std::visit([&](const auto& solid) { return solid.lower_by_normal(x, v); }, primitive);
}

double upper_by_point(const PosedSuperquadric& solid, const PreciseVector& q, const Proposal& v) {
  if (solid.bounds().gauge_up(q) <= Real(1)) return 0.0;
  if (!usable(v)) return infinity;
  return upper_bound_at(solid.bounds(), q, PreciseVector(q - precise(v)));
}

}  // namespace verisq::verify
