/// Outside Newton's method in logarithms; inside walks from plane to plane, and Newton's method where that leads
/// farther.
#include "host/fit/tapered_projection.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "host/fit/log_sum.hpp"
#include "verify/proof/superquadric.hpp"
#include "verify/search/contact.hpp"

namespace verisq::fit_search {

namespace {

using Eigen::Array3d;
using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kSteadyNormal = 1e-8;
constexpr int kMostFocalRounds = 40;
/// Of Newton's equations: nearer to a centre of curvature planes lead on alone.
constexpr double kLeastDeterminant = 1e-3;
/// Of the size: how near a point outside is to the closest point's normal. The distance is off by about its square.
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
  double distance;  ///< of q, negative inside
  Vector3d normal;  ///< of length 1
  double inverse_length;
};

/// And where it touches the solid: at M u.
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

/// Whether the plane touches the solid where q, outside, is closest.
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
