/// Superquadric, taper (docs/mathematics.md §18), bend (§9) and pose in plain binary64.
#include "host/tessellation/placed_primitive.hpp"

#include <algorithm>
#include <boost/math/special_functions/cos_pi.hpp>
#include <boost/math/special_functions/sin_pi.hpp>
#include <boost/math/special_functions/sinc.hpp>
#include <cmath>
#include <numbers>

#include "host/batches/rotation.hpp"

namespace verisq::tessellation {
namespace {

/// (|a|^(2/e) + |b|^(2/e))^(e/2): of degree 1, so that the larger can be taken out before the powers underflow.
double superellipse_gauge(double a, double b, double exponent) {
  const double larger = std::max(std::abs(a), std::abs(b));
  const double smaller = std::min(std::abs(a), std::abs(b));
  if (larger == 0.0) return 0.0;
  const double ratio = smaller / larger;
  if (exponent == 1.0) return larger * std::sqrt(1.0 + ratio * ratio);  // circles need no powers
  return larger * std::pow(1.0 + std::pow(ratio, 2.0 / exponent), exponent / 2.0);
}

/// Where the taper takes a point, in semi-axes.
Eigen::Array3d tapered(const Eigen::Array3d& point, double k) {
  const double z = (point[2] - k) / (1.0 - k * point[2]);
  const double scale = 1.0 + k * z;
  return {scale * point[0], scale * point[1], z};
}

/// Undoes it. Precondition: |z| <= 1.
Eigen::Array3d untapered(const Eigen::Array3d& point, double k) {
  return Eigen::Array3d(point[0], point[1], point[2] + k) / (1.0 + k * point[2]);
}

Eigen::Matrix3d matrix(const std::array<double, 9>& rows) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rows.data());
}

}  // namespace

Eigen::Vector2d superellipse(double quarter_turns, double exponent) {
  // Exact zeros at the axes: neighbouring quarters share their points bit by bit.
  const double x = boost::math::cos_pi(quarter_turns / 2.0);
  const double y = boost::math::sin_pi(quarter_turns / 2.0);
  return Eigen::Vector2d(x, y) / superellipse_gauge(x, y, exponent);
}

PlacedPrimitive::PlacedPrimitive(const Primitive& primitive)
    : semi_axes_(primitive.superquadric.semi_axes[0], primitive.superquadric.semi_axes[1],
                 primitive.superquadric.semi_axes[2]),
      exponents_(primitive.superquadric.exponents),
      k_((primitive.superquadric.taper - 1.0) / (primitive.superquadric.taper + 1.0)),
      rotation_(matrix(device::rotation_matrix(primitive.pose.quaternion))),
      translation_(primitive.pose.translation[0], primitive.pose.translation[1], primitive.pose.translation[2]) {
  // A solid with exponents up to 1 holds the ellipsoid of its semi-axes, any other the octahedron.
  steepness_ = smallest_semi_axis() / (std::max(exponents_[0], exponents_[1]) > 1.0 ? std::numbers::sqrt3 : 1.0);
  if (!primitive.bend) return;
  const double half_turns = primitive.bend->angle_degrees / 180.0;
  arc_ = {primitive.bend->curvature, boost::math::cos_pi(half_turns), boost::math::sin_pi(half_turns)};
  const double reach = std::abs(arc_.curvature) * std::hypot(semi_axes_[0], semi_axes_[1]) * (1.0 + std::abs(k_));
  steepness_ *= std::max(1.0 - reach, 0.1);
}

Eigen::Vector3d PlacedPrimitive::surface_point(const SurfaceParameters& parameters) const {
  const Eigen::Vector2d along = superellipse(parameters.latitude, exponents_[0]);
  const Eigen::Vector2d around = superellipse(parameters.longitude, exponents_[1]);
  const Eigen::Array3d unit(along[0] * around[0], along[0] * around[1], along[1]);
  return rotation_ * arc_.bent((tapered(unit, k_) * semi_axes_).matrix()) + translation_;
}

bool PlacedPrimitive::contains(const Eigen::Vector3d& point) const {
  const Eigen::Array3d placed = in_semi_axes(point);
  if (std::abs(placed[2]) > 1.0) return false;
  const Eigen::Array3d unit = untapered(placed, k_);
  const Eigen::Array3d magnitudes = unit.abs();
  // Between the octahedron, which exponents up to 2 leave inside, and the cube the gauge decides.
  if (magnitudes.maxCoeff() > 1.0) return false;
  return magnitudes.sum() <= 1.0 || gauge(unit) <= 1.0;
}

double PlacedPrimitive::level(const Eigen::Vector3d& point) const {
  Eigen::Array3d placed = in_semi_axes(point);
  // The taper's inverse has a pole beyond the ends: from there on the height alone counts.
  const double beyond = std::max(std::abs(placed[2]) - 1.0, 0.0);
  placed[2] = std::clamp(placed[2], -1.0, 1.0);
  return (gauge(untapered(placed, k_)) - 1.0 + beyond) * steepness_;
}

Eigen::Array3d PlacedPrimitive::in_semi_axes(const Eigen::Vector3d& point) const {
  return arc_.unbent(rotation_.transpose() * (point - translation_)).array() / semi_axes_;
}

double PlacedPrimitive::gauge(const Eigen::Array3d& unit) const {
  return superellipse_gauge(superellipse_gauge(unit[0], unit[1], exponents_[1]), unit[2], exponents_[0]);
}

Eigen::Vector3d PlacedPrimitive::Arc::bent(const Eigen::Vector3d& unbent) const {
  if (curvature == 0.0) return unbent;
  const double r = unbent[0] * cosine + unbent[1] * sine;
  const double s = unbent[1] * cosine - unbent[0] * sine;
  const double angle = curvature * unbent[2];
  // (1 - cos kz) / k without its cancellation
  const double along = r * std::cos(angle) + unbent[2] * std::sin(angle / 2.0) * boost::math::sinc_pi(angle / 2.0);
  const double up = (1.0 - curvature * r) * unbent[2] * boost::math::sinc_pi(angle);
  return {along * cosine - s * sine, along * sine + s * cosine, up};
}

Eigen::Vector3d PlacedPrimitive::Arc::unbent(const Eigen::Vector3d& bent) const {
  if (curvature == 0.0) return bent;
  const double along = bent[0] * cosine + bent[1] * sine;
  const double s = bent[1] * cosine - bent[0] * sine;
  const double m = 1.0 - curvature * along;
  const double rise = curvature * bent[2];
  const double r = (2.0 * along - curvature * (along * along + bent[2] * bent[2])) / (1.0 + std::hypot(m, rise));
  return {r * cosine - s * sine, r * sine + s * cosine, std::atan2(rise, m) / curvature};
}

}  // namespace verisq::tessellation
