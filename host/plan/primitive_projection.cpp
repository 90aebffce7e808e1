/// This file implements primitive_projection.hpp.

#include "host/plan/primitive_projection.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "verify/solids/superquadric.hpp"

namespace verisq::fit_search {

namespace {

using Eigen::Array3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kMostSteps = 40;
/// Share of the semi-axes: the error of the distance is of second order in that of the foot.
constexpr double kSteady = 1e-6;
/// If |β(x) - q|² curves downwards along the axis, or hardly upwards, the step takes this share of the chord instead.
constexpr double kLeastShare = 0.25;
constexpr double kLeastMetric = 1e-6;

double sine_quotient(double angle) {
  return angle == 0.0 ? 1.0 : std::sin(angle) / angle;
}

/// The rotation about y by which the bend turns a section at angle k z: r towards z.
Vector3d turned(const Vector3d& v, double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  return {c * v[0] + s * v[2], v[1], c * v[2] - s * v[0]};
}

/// The projection for tapered solids is the faster one, by far from inside.
Projection projected(const Superquadric& solid, const Vector3d& q) {
  return std::ranges::max(solid.exponents) < 2.0 ? TaperedProjection(solid)(q) : SuperquadricProjection(solid)(q);
}

}  // namespace

BentProjection::BentProjection(const Superquadric& solid, const Bend& bend)
    : solid_(solid), curvature_(bend.curvature), turn_(Matrix3d::Identity()) {
  const double angle = bend.angle_degrees * std::numbers::pi / 180.0;
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  turn_.topLeftCorner<2, 2>() << c, s, -s, c;
  // A box of K in the frame of the bend, then of the arcs about the centre of curvature that it becomes.
  const auto& [a, b, height] = solid.semi_axes;
  const double widening = 1.0 + std::abs(verify::taper_coefficient<double>(solid.taper));
  const double reach = widening * (a * std::abs(c) + b * std::abs(s));
  const double breadth = widening * (a * std::abs(s) + b * std::abs(c));
  const double k = std::abs(curvature_);
  const double end = std::min(k * height, std::numbers::pi);
  const double widest = 1.0 + k * reach;
  const double sagitta = height * std::sin(end / 2.0) * sine_quotient(end / 2.0);  // of the axis' ends
  // Towards the centre of curvature: the sagitta plus the extent of the end's section in this direction; away from it:
  // the outer side.
  const double inward = sagitta + reach;
  const double sideways = end < std::numbers::pi / 2.0 ? height * widest * sine_quotient(end) : widest / k;
  box_lower_ = {curvature_ > 0.0 ? -reach : -inward, -breadth, -sideways};
  box_upper_ = {curvature_ > 0.0 ? inward : reach, breadth, sideways};
}

Vector3d BentProjection::bent(const Vector3d& x) const {
  const double angle = curvature_ * x[2];
  const double sagitta = x[2] * std::sin(angle / 2.0) * sine_quotient(angle / 2.0);
  return {x[0] * std::cos(angle) + sagitta, x[1], (1.0 - curvature_ * x[0]) * x[2] * sine_quotient(angle)};
}

/// Without cancellation for small curvatures (docs/mathematics.md §9).
Vector3d BentProjection::unbent(const Vector3d& x) const {
  const double m = 1.0 - curvature_ * x[0];
  const double rise = curvature_ * x[2];
  const double w = std::hypot(m, rise);
  const double angle = std::atan2(rise, m);
  const double z = rise == 0.0 && m > 0.0 ? x[2] / m : angle / curvature_;
  return {(2.0 * x[0] - curvature_ * (x[0] * x[0] + x[2] * x[2])) / (1.0 + w), x[1], z};
}

/// The point of the surface of K nearest to t where z counts sqrt(metric) times.
BentProjection::Foot BentProjection::foot(const Vector3d& t, double metric) const {
  const double stretch = std::sqrt(metric);
  Superquadric stretched = solid_;
  stretched.semi_axes[2] *= stretch;
  Vector3d own = turn_.transpose() * t;
  own[2] *= stretch;
  auto [distance, normal, nearest] = projected(stretched, own);
  nearest[2] /= stretch;
  normal[2] *= stretch;
  return {turn_ * nearest, (turn_ * normal).normalized(), distance < 0.0};
}

/// Newton's method with the diagonal of the Hessian of f/2 = |β(x) - q|²/2 at x,
///     1          0   -W_q sin δ
///     0          1    0
///    -W_q sin δ  0    W W_q cos δ,
/// shortened by as much as the entry beside it may raise f above this model. A foot that stays where it is has its
/// normal along the gradient of f.
BentProjection::Foot BentProjection::step(const Foot& from, const Vector3d& q) const {
  const Vector3d& x = from.point;
  const double angle = curvature_ * x[2];
  const double w = 1.0 - curvature_ * x[0];
  Vector3d gradient = turned(bent(x) - q, -angle);
  gradient[2] *= w;
  // W_q cos δ and W_q sin δ, from the query relative to the centre of curvature.
  const double m = 1.0 - curvature_ * q[0];
  const double rise = curvature_ * q[2];
  const double along = m * std::cos(angle) + rise * std::sin(angle);
  const double across = m * std::sin(angle) - rise * std::cos(angle);
  const double metric = std::max({w * along, kLeastShare * w * std::hypot(along, across), kLeastMetric});
  const double length = 1.0 / (1.0 + std::abs(across) / std::sqrt(metric));
  gradient[2] /= metric;
  return foot(x - length * gradient, metric);
}

/// β'(x)ᵀ takes the normal of β(K) to one of K, so its inverse takes that of K to one of β(K).
Projection BentProjection::projection(const Foot& foot, const Vector3d& q, bool inside) const {
  const double w = 1.0 - curvature_ * foot.point[0];
  Vector3d normal = foot.normal;
  normal[2] /= w;
  normal = turned(normal.normalized(), curvature_ * foot.point[2]);
  const Vector3d nearest = bent(foot.point);
  const double distance = (q - nearest).norm();
  return {inside ? -distance : distance, turn_.transpose() * normal, turn_.transpose() * nearest};
}

Projection BentProjection::operator()(const Vector3d& own) const {
  const Vector3d q = turn_ * own;
  const double size = std::ranges::max(solid_.semi_axes);
  Foot at = foot(unbent(q), 1.0);
  const bool inside = at.inside;
  Projection best = projection(at, q, inside);
  for (int i = 0; i < kMostSteps; ++i) {
    const Foot next = step(at, q);
    const double change = (next.point - at.point).norm();
    if (!std::isfinite(change)) break;
    at = next;
    const Projection found = projection(at, q, inside);
    if (std::abs(found.distance) <= std::abs(best.distance)) best = found;
    if (change < kSteady * size) break;
  }
  return best;
}

Vector3d BentProjection::image(const Vector3d& own) const {
  return turn_.transpose() * bent(turn_ * own);
}

/// The derivatives of |β(x) - q| with x in proportion to the semi-axes.
Vector3d BentProjection::size_gradient(const Projection& found) const {
  const Vector3d x = unbent(turn_ * found.nearest);
  Vector3d pulled_back = turned(turn_ * found.normal, -curvature_ * x[2]);
  pulled_back[2] *= 1.0 - curvature_ * x[0];
  return fit_search::size_gradient(turn_.transpose() * pulled_back, turn_.transpose() * x, solid_);
}

double BentProjection::lower_bound(const Vector3d& own) const {
  const Array3d q = (turn_ * own).array();
  const Array3d beyond = (box_lower_ - q).max(q - box_upper_);
  const double largest = beyond.maxCoeff();
  return largest > 0.0 ? beyond.max(0.0).matrix().norm() : largest;
}

}  // namespace verisq::fit_search
