/// The solids without bends of primitive_projection.hpp.
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "host/plan/primitive_projection.hpp"
#include "verify/proposals/multipliers.hpp"
#include "verify/search/contact.hpp"
#include "verify/search/convex_primitive.hpp"
#include "verify/solids/superquadric.hpp"

namespace verisq::fit_search {

namespace {

using Eigen::Array3d;
using Eigen::Vector3d;

constexpr verify::InnerWalkLimits kWalks{.steady_direction = 1e-7, .most_walks = 60};
/// Share of the semi-axes: the tolerance of the proof that replaces Newton's method if that fails.
constexpr double kProofTolerance = 1e-9;

}  // namespace

SuperquadricProjection::SuperquadricProjection(const Superquadric& solid)
    : solid_(solid), outside_(solid), boundary_(solid) {}

double SuperquadricProjection::lower_bound(const Vector3d& q) const {
  const Array3d beyond = q.array().abs() - Array3d(solid_.semi_axes[0], solid_.semi_axes[1], solid_.semi_axes[2]);
  const double largest = beyond.maxCoeff();
  return largest > 0.0 ? beyond.max(0.0).matrix().norm() : largest;
}

Projection SuperquadricProjection::operator()(const Vector3d& q) const {
  const verify::DistanceExpansion found = outside_(q);
  if (found.inside) return from_inside(q);
  const double distance = found.gradient.norm();
  if (!std::isfinite(found.value) || !(distance > 0.0)) return proven(q);
  return {distance, found.gradient / distance, q - found.gradient};
}

Projection SuperquadricProjection::from_inside(const Vector3d& q) const {
  const verify::InnerWalk walk =
      verify::shortest_walk(boundary_, false, {std::fabs(q[0]), std::fabs(q[1]), std::fabs(q[2])}, kWalks);
  Vector3d normal;
  for (int i = 0; i < 3; ++i) normal[i] = std::copysign(walk.direction[static_cast<std::size_t>(i)], q[i]);
  return {-walk.length, normal, q + walk.length * normal};
}

Projection SuperquadricProjection::proven(const Vector3d& q) const {
  const double tolerance = kProofTolerance * std::ranges::max(solid_.semi_axes);
  const verify::PrimitiveDistance found =
      verify::ConvexPrimitive({"", solid_, {}, {}}).signed_distance({q[0], q[1], q[2]}, tolerance);
  const Vector3d direction(static_cast<double>(found.direction[0]), static_cast<double>(found.direction[1]),
                           static_cast<double>(found.direction[2]));
  const double distance = std::midpoint(found.distance.lo, found.distance.hi);
  const Vector3d normal = direction.stableNormalized();
  return {distance, normal, q - distance * normal};
}

namespace {

using Eigen::Array3d;
using Eigen::Vector3d;

// The numbers are those of kernels/proposal.clh and kernels/tapered_enclosure.clh, which give the reasons.
constexpr double kSmallest = 1e-60;
constexpr double kFarLogGauge = 0.05;
constexpr double kBoxExponent = 4.0;
constexpr double kNearGauge = 1.1;
constexpr double kStrongTaper = 0.5;
constexpr double kLowestStart = 1e-4;
constexpr double kStartBesideSection = -0.3;
constexpr double kLargestLogStep = 8.0;
constexpr double kLargestDampedStep = 3.0;
constexpr double kCollapsedLog = -40.0;
constexpr double kSmallestDerivative = 1e-12;
constexpr double kSmallestExcess = 1e-12;
constexpr double kConvergedStep = 1e-9;
constexpr int kMostSteps = 40;

double away_from_zero(double derivative) {
  return std::copysign(std::max(std::fabs(derivative), kSmallestDerivative), derivative);
}

}  // namespace

/// The query as seen from the side of the widest section on which the closest point is assumed to lie.
struct TaperedNewton::Query {
  Array3d point;  ///< z is signed
  Array3d logs;   ///< of magnitudes
  double pushed_z;
  double k;
};

struct TaperedNewton::Unknowns {
  Array3d coordinates;  ///< logarithms, in units of the semi-axes
  double r, lambda;
};

struct TaperedNewton::Equations {
  LogSum x, y;
  double fx, fy, fz, section_residual, surface_residual;
  Array3d inverses;
  double section_x, section_y, surface_r, surface_z;
  double z_share, scale_rise;
  double a11, a12, a22;
};

TaperedNewton::TaperedNewton(const Superquadric& solid)
    : axes_(solid.semi_axes[0], solid.semi_axes[1], solid.semi_axes[2]),
      log_axes_(axes_.log()),
      p1_(2.0 / solid.exponents[0]),
      p2_(2.0 / solid.exponents[1]),
      k_(verify::taper_coefficient<double>(solid.taper)),
      fall_(1.0 - k_ * k_) {}

double TaperedNewton::beyond_section(double q, double share_beyond, int axis) const {
  const double beyond = p2_ >= kBoxExponent ? q - fall_ * axes_[axis] : q * share_beyond;
  return axes_[axis] * std::max(beyond, kSmallest);
}

double TaperedNewton::pushed_height(const Vector3d& q) const {
  const double x = std::log(std::max(q[0], kSmallest)) - log_axes_[0];
  const double y = std::log(std::max(q[1], kSmallest)) - log_axes_[1];
  const double r = log_sum(p2_ * x, p2_ * y).value / p2_;
  const double share_beyond = 1.0 - fall_ * bounded_exp(-r);
  const double dual = p2_ / (p2_ - 1.0);
  const double a = beyond_section(q[0], share_beyond, 0);
  const double b = beyond_section(q[1], share_beyond, 1);
  const double multiplier = std::exp(log_sum(dual * std::log(a), dual * std::log(b)).value / dual);
  return q[2] + multiplier * k_ / axes_[2];
}

std::optional<double> TaperedNewton::height_on_wall(const Query& q) const {
  if (p1_ < kBoxExponent || std::fabs(q.k) >= kStrongTaper) return std::nullopt;
  const double height = q.pushed_z / (fall_ * axes_[2] + q.k * q.pushed_z);
  const bool below_end = height < 1.0 || q.point[2] < axes_[2] * (1.0 + q.k);
  if (!(height > kLowestStart && below_end)) return std::nullopt;
  const double highest = q.k > 0.0 ? std::log(std::max(q.k, kLowestStart)) / (p1_ - 1.0) : 0.0;
  return std::min(highest, std::log(height));
}

/// The start on the ray to q; if the solid is much like a box, q is first cut off at the semi-axes. λ by least squares
/// of u + λ n = q.
TaperedNewton::Unknowns TaperedNewton::start_untapered(const Array3d& q, const Array3d& log_q) const {
  Array3d cut = log_q - log_axes_;
  if (cut.maxCoeff() > kFarLogGauge) {
    if (p2_ >= kBoxExponent) cut.head<2>() = cut.head<2>().min(0.0);
    if (p1_ >= kBoxExponent) cut[2] = std::min(cut[2], 0.0);
  }
  const double r = log_sum(p2_ * cut[0], p2_ * cut[1]).value / p2_;
  const double gauge = log_sum(p1_ * r, p1_ * cut[2]).value / p1_;
  Unknowns u{cut - gauge, r - gauge, 0.0};
  const double in_section = (p1_ - p2_) * u.r;
  const Array3d n(bounded_exp(in_section + (p2_ - 1.0) * u.coordinates[0] - log_axes_[0]),
                  bounded_exp(in_section + (p2_ - 1.0) * u.coordinates[1] - log_axes_[1]),
                  bounded_exp((p1_ - 1.0) * u.coordinates[2] - log_axes_[2]));
  u.lambda = std::log(std::max((n * q).sum() - 1.0, kSmallestExcess) / n.square().sum());
  return u;
}

TaperedNewton::Unknowns TaperedNewton::start(const Query& q) const {
  const Array3d scaled = q.logs - log_axes_;
  const double r = log_sum(p2_ * scaled[0], p2_ * scaled[1]).value / p2_;
  const double log_norm = log_sum(p1_ * r, p1_ * scaled[2]).value / p1_;
  const double gauge = (bounded_exp(log_norm) - q.k * q.point[2] / axes_[2]) / fall_;
  std::optional<double> beside = height_on_wall(q);
  if (beside && !(gauge > kNearGauge) && q.point[2] >= 0.0) beside.reset();
  if (!beside && q.point[2] < 0.0) beside = kStartBesideSection;
  const double log_z = std::min(beside.value_or(scaled[2] - log_norm), 0.0);
  const double inverse_scale = (1.0 - q.k * bounded_exp(log_z)) / fall_;
  Array3d point = q.point * inverse_scale;
  Array3d logs = q.logs + std::log(inverse_scale);
  if (beside) {
    point[2] = axes_[2] * bounded_exp(log_z);
    logs[2] = log_axes_[2] + log_z;
  }
  return start_untapered(point, logs);
}

TaperedNewton::Equations TaperedNewton::equations_at(const Unknowns& u, const Query& q) const {
  Equations e;
  const double in_section = u.lambda + (p1_ - p2_) * u.r;
  e.x = log_sum(u.coordinates[0] + log_axes_[0], in_section + (p2_ - 1.0) * u.coordinates[0] - log_axes_[0]);
  e.y = log_sum(u.coordinates[1] + log_axes_[1], in_section + (p2_ - 1.0) * u.coordinates[1] - log_axes_[1]);

  const double z = bounded_exp(u.coordinates[2]);
  const double room = 1.0 - q.k * z;
  const double log_scale = std::log(fall_) - std::log(room);
  e.scale_rise = q.k * z / room;
  const double own = axes_[2] * z;
  const double pushed = bounded_exp(u.lambda + (p1_ - 1.0) * u.coordinates[2] - log_axes_[2]);
  const double tilted = q.k * bounded_exp(u.lambda - log_axes_[2]);
  const double asked = q.point[2] * room / fall_;
  const double left = own + pushed + std::max(-tilted, 0.0) + std::max(-asked, 0.0);
  const double right = std::max(std::max(tilted, 0.0) + std::max(asked, 0.0), kSmallest);
  e.fx = e.x.value - q.logs[0] + log_scale;
  e.fy = e.y.value - q.logs[1] + log_scale;
  e.fz = std::log(std::max(left / right, kSmallest));
  e.z_share = (pushed + std::max(-tilted, 0.0)) / left - std::max(tilted, 0.0) / right;
  const double rise_z = (own + (p1_ - 1.0) * pushed - e.scale_rise * std::max(-asked, 0.0)) / left +
                        e.scale_rise * std::max(asked, 0.0) / right;

  const LogSum section = log_sum(p2_ * u.coordinates[0], p2_ * u.coordinates[1]);
  const LogSum surface = log_sum(p1_ * u.r, p1_ * u.coordinates[2]);
  e.section_residual = section.value / p2_ - u.r;
  e.surface_residual = surface.value / p1_;
  e.inverses = {1.0 / std::max(1.0 + e.x.share * (p2_ - 2.0), kSmallestDerivative),
                1.0 / std::max(1.0 + e.y.share * (p2_ - 2.0), kSmallestDerivative), 1.0 / away_from_zero(rise_z)};
  e.section_x = (1.0 - section.share) * e.inverses[0];
  e.section_y = section.share * e.inverses[1];
  e.surface_z = surface.share * e.inverses[2];
  e.surface_r = 1.0 - surface.share;
  const double share = e.section_x * e.x.share + e.section_y * e.y.share;
  e.a11 = 1.0 + (p1_ - p2_) * share;
  e.a12 = share - e.scale_rise * e.inverses[2] * e.z_share * (e.section_x + e.section_y);
  e.a22 = e.surface_z * e.z_share;
  return e;
}

TaperedNewton::Unknowns TaperedNewton::step(const Equations& e) const {
  const double moved = e.scale_rise * e.inverses[2];
  const double b1 = e.section_residual - (e.section_x * (e.fx - moved * e.fz) + e.section_y * (e.fy - moved * e.fz));
  const double b2 = e.surface_z * e.fz - e.surface_residual;
  const double determinant = e.a11 * e.a22 + e.a12 * e.surface_r;
  Unknowns d;
  d.r = (b1 * e.a22 + e.a12 * b2) / determinant;
  d.lambda = (e.surface_r * b1 - e.a11 * b2) / determinant;
  d.coordinates[2] = -(e.fz + e.z_share * d.lambda) * e.inverses[2];
  const double coupled = d.lambda + (p1_ - p2_) * d.r;
  const double scaled = e.scale_rise * d.coordinates[2];
  d.coordinates[0] = -(e.fx + e.x.share * coupled + scaled) * e.inverses[0];
  d.coordinates[1] = -(e.fy + e.y.share * coupled + scaled) * e.inverses[1];
  return d;
}

std::optional<Vector3d> TaperedNewton::on_side(const Vector3d& point, double pushed, double side) const {
  const Query q{
      {point[0], point[1], side * point[2]}, point.array().abs().max(kSmallest).log(), side * pushed, side * k_};
  const double lowest_section_step = -kLargestLogStep / std::clamp(p2_ - 1.0, 1e-3, 1.0);
  const double lowest_z_step = -kLargestLogStep / std::clamp(p1_ - 1.0, 1e-3, 1.0);
  const Array3d lowest(lowest_section_step, lowest_section_step, lowest_z_step);
  Unknowns u = start(q);
  for (int round = 0; round < kMostSteps; ++round) {
    const Unknowns d = step(equations_at(u, q));
    const double largest = std::max(std::fabs(d.r), std::fabs(d.lambda));
    if (!std::isfinite(largest)) return std::nullopt;
    const double damping = std::min(1.0, kLargestDampedStep / largest);
    u.coordinates += (damping * d.coordinates).max(lowest).min(kLargestLogStep);
    u.coordinates[2] = std::min(u.coordinates[2], 0.0);
    u.r += damping * d.r;
    u.lambda += damping * d.lambda;
    if (u.coordinates[2] * std::min(p1_ - 1.0, 1.0) < kCollapsedLog) return std::nullopt;
    if (largest > kConvergedStep || d.coordinates.abs().maxCoeff() > kConvergedStep) continue;
    const Array3d magnitudes = axes_ * u.coordinates.max(-300.0).exp();
    return Vector3d(magnitudes[0], magnitudes[1], side * magnitudes[2]);
  }
  return std::nullopt;
}

std::optional<Vector3d> TaperedNewton::operator()(const Vector3d& q) const {
  const double pushed = pushed_height(q);
  const double side = pushed < 0.0 ? -1.0 : 1.0;
  const std::optional<Vector3d> found = on_side(q, pushed, side);
  return found ? found : on_side(q, pushed, -side);
}

namespace {

using Eigen::Array3d;
using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kSteadyNormal = 1e-8;
constexpr int kMostFocalRounds = 40;
/// The least determinant of Newton's equations: nearer to a centre of curvature planes alone continue the search.
constexpr double kLeastDeterminant = 1e-3;
/// Share of the size: the allowed distance of a point outside from the closest point's normal. The distance is off by
/// about its square.
constexpr double kOffNormal = 1e-7;
/// Beyond, Newton's method often fails. A smaller exponent gives a larger solid: penetrations are overestimated.
constexpr double kLargestExponent = 1.95;
constexpr double kSmallestExponent = 1e-9;

double log_or_lowest(double x) {
  return std::log(std::max(x, std::numeric_limits<double>::min()));
}

std::array<double, 2> exponents_of(const Superquadric& solid) {
  return {std::clamp(solid.exponents[0], kSmallestExponent, kLargestExponent),
          std::clamp(solid.exponents[1], kSmallestExponent, kLargestExponent)};
}

Vector3d tangential_part(const Vector3d& a, const Vector3d& unit_normal) {
  return a - a.dot(unit_normal) * unit_normal;
}

}  // namespace

/// A tangent plane.
struct TaperedProjection::Plane {
  double distance;  ///< signed distance of q, negative inside
  Vector3d normal;  ///< of length 1
  double inverse_length;
};

/// The plane and the point where it touches the solid: M u.
struct TaperedProjection::BoundaryPlane {
  Plane plane;
  Array3d u;  ///< logarithms of |coordinates| in units of the semi-axes
  double r;   ///< of their section
  double side;
  Vector3d point;  ///< M u
};

TaperedProjection::TaperedProjection(const Superquadric& solid)
    : solid_{solid.semi_axes, exponents_of(solid), solid.taper},
      axes_(solid.semi_axes[0], solid.semi_axes[1], solid.semi_axes[2]),
      p1_(2.0 / solid_.exponents[0]),
      p2_(2.0 / solid_.exponents[1]),
      k_(verify::taper_coefficient<double>(solid.taper)),
      fall_(1.0 - k_ * k_),
      newton_(solid_) {}

double TaperedProjection::lower_bound(const Vector3d& q) const {
  const double widening = 1.0 + std::fabs(k_);
  const Array3d beyond = q.array().abs() - axes_ * Array3d(widening, widening, 1.0);
  const double largest = beyond.maxCoeff();
  return largest > 0.0 ? beyond.max(0.0).matrix().norm() : largest;
}

/// v.w = 1 - k² there.
TaperedProjection::Plane TaperedProjection::plane(const Vector3d& v, const Vector3d& q) const {
  const double inverse_length = 1.0 / v.norm();
  return {(v.dot(q) - fall_) * inverse_length, v * inverse_length, inverse_length};
}

TaperedProjection::Plane TaperedProjection::nearest_end_or_wall(const Vector3d& q) const {
  const double tilt = -k_ / axes_[2];
  const std::array<Plane, 4> planes{plane({0.0, 0.0, tilt + 1.0 / axes_[2]}, q),
                                    plane({0.0, 0.0, tilt - 1.0 / axes_[2]}, q), plane({1.0 / axes_[0], 0.0, tilt}, q),
                                    plane({0.0, 1.0 / axes_[1], tilt}, q)};
  return *std::ranges::max_element(planes, {}, &Plane::distance);
}

TaperedProjection::BoundaryPlane TaperedProjection::plane_through(const Vector3d& x, const Vector3d& q) const {
  BoundaryPlane found;
  for (int i = 0; i < 3; ++i) found.u[i] = log_or_lowest(std::fabs(x[i])) - std::log(axes_[i]);
  found.r = log_sum(p2_ * found.u[0], p2_ * found.u[1]).value / p2_;
  const double norm = log_sum(p1_ * found.r, p1_ * found.u[2]).value / p1_;
  found.u -= norm;
  found.r -= norm;
  found.side = std::copysign(1.0, x[2]);
  const double in_section = (p1_ - p2_) * found.r;
  const Vector3d v(bounded_exp(in_section + (p2_ - 1.0) * found.u[0]) / axes_[0],
                   bounded_exp(in_section + (p2_ - 1.0) * found.u[1]) / axes_[1],
                   (found.side * bounded_exp((p1_ - 1.0) * found.u[2]) - k_) / axes_[2]);
  found.plane = plane(v, q);
  const double z = found.side * bounded_exp(found.u[2]);
  const Array3d share(bounded_exp(found.u[0]), bounded_exp(found.u[1]), z);
  found.point = (fall_ / (1.0 - k_ * z) * axes_ * share).matrix();
  return found;
}

// The Hessian of N at u is w wᵀ + t tᵀ; see kernels/tapered_distance_gradient.clh.
Vector3d TaperedProjection::newton_step(const BoundaryPlane& at, const Vector3d& q) const {
  const Vector3d& n = at.plane.normal;
  const Vector3d foot = q - at.plane.distance * n;
  const double of_w = 0.5 * ((p1_ - 2.0) * (at.r + at.u[2]) + std::log(p1_ - 1.0));
  const double of_t = 0.5 * ((p2_ - 2.0) * (at.u[0] + at.u[1]) + (p1_ - 2.0 * p2_) * at.r + std::log(p2_ - 1.0));
  const Vector3d w(bounded_exp(of_w + at.u[2] + (p2_ - 1.0) * (at.u[0] - at.r)) / axes_[0],
                   bounded_exp(of_w + at.u[2] + (p2_ - 1.0) * (at.u[1] - at.r)) / axes_[1],
                   -at.side * bounded_exp(of_w + at.r) / axes_[2]);
  const Vector3d t(bounded_exp(of_t + at.u[1]) / axes_[0], -bounded_exp(of_t + at.u[0]) / axes_[1], 0.0);
  Eigen::Matrix<double, 3, 2> roots;
  roots << tangential_part(w, n), tangential_part(t, n);
  const double room = 1.0 - k_ * at.side * bounded_exp(at.u[2]);
  const double c = -at.plane.distance * at.plane.inverse_length * room / fall_;
  const Matrix2d equations = Matrix2d::Identity() - c * roots.transpose() * roots;
  const Vector3d e = tangential_part(foot - at.point, n);
  if (!(equations(0, 0) > 0.0 && equations.determinant() > kLeastDeterminant)) return foot;
  const Vector3d next = at.point + e + roots * (equations.inverse() * (c * roots.transpose() * e));
  return next.squaredNorm() <= 16.0 * axes_.square().sum() ? next : foot;
}

TaperedProjection::BoundaryPlane TaperedProjection::nearest_plane(const Plane& first, const Vector3d& q) const {
  BoundaryPlane nearest = plane_through(q - first.distance * first.normal, q);
  bool by_newton = true;
  for (int round = 0; round < kMostFocalRounds; ++round) {
    const Vector3d x =
        by_newton ? newton_step(nearest, q) : Vector3d(q - nearest.plane.distance * nearest.plane.normal);
    const BoundaryPlane next = plane_through(x, q);
    const bool steady = (next.plane.normal - nearest.plane.normal).norm() <= kSteadyNormal;
    const bool nearer = next.plane.distance > nearest.plane.distance;
    if (nearer) nearest = next;
    if (steady || !(nearer || by_newton)) break;
    by_newton = nearer;
  }
  return nearest;
}

/// Returns whether the plane touches the solid at the point closest to q, which is outside.
bool TaperedProjection::closest(const BoundaryPlane& at, const Vector3d& q) const {
  return tangential_part(q - at.point, at.plane.normal).norm() <= kOffNormal * axes_.maxCoeff();
}

Projection TaperedProjection::operator()(const Vector3d& p) const {
  const Vector3d q(std::fabs(p[0]), std::fabs(p[1]), p[2] + k_ * axes_[2]);  // about the focus
  const BoundaryPlane radial = plane_through(q, q);
  if (radial.plane.distance > 0.0) {
    if (const std::optional<Vector3d> u = newton_(q)) {
      const BoundaryPlane found = plane_through(*u, q);
      if (closest(found, q)) return projection(found.plane, p);
    }
  }
  const Plane other = nearest_end_or_wall(q);
  const Plane first = other.distance > radial.plane.distance ? other : radial.plane;
  const BoundaryPlane nearest = nearest_plane(first, q);
  const Plane& found = first.distance > nearest.plane.distance ? first : nearest.plane;
  if (found.distance > 0.0 && !closest(nearest, q)) return by_contact(p);
  return projection(found, p);
}

Projection TaperedProjection::projection(const Plane& plane, const Vector3d& p) {
  const Vector3d normal(std::copysign(plane.normal[0], p[0]), std::copysign(plane.normal[1], p[1]), plane.normal[2]);
  return {plane.distance, normal, p - plane.distance * normal};
}

Projection TaperedProjection::by_contact(const Vector3d& p) const {
  const Vector3d q(p[0], p[1], p[2] + k_ * axes_[2]);
  const verify::Contact contact = verify::fast_contact(solid_, {q[0], q[1], q[2]});
  Vector3d point;
  Vector3d normal;
  for (std::size_t i = 0; i < 3; ++i) {
    point[static_cast<Eigen::Index>(i)] = static_cast<double>(contact.point[i]);
    normal[static_cast<Eigen::Index>(i)] = static_cast<double>(contact.normal[i]);
  }
  const double distance = (q - point).norm();
  return {distance, normal.stableNormalized(), p - distance * normal.stableNormalized()};
}

}  // namespace verisq::fit_search
