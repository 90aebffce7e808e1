/// Derivatives by the chain rule through S = (x/a1)^p2 + (y/a2)^p2, so that F = S^(p1/p2) + (z/a3)^p1.
#include "bench/implicit_superquadric.hpp"

#include <algorithm>
#include <cmath>

#include "bench/approximate_motion.hpp"
#include "bench/points.hpp"

namespace verisq::bench {
namespace {

constexpr double nearest_to_zero = 1e-8;
constexpr double off_the_planes = 0.01;

/// |u|^power of a coordinate u = x / semi_axis, and its derivatives by x.
struct Power {
  Power(double x, double semi_axis, double power) {
    const double u = std::abs(x) / semi_axis;
    value = std::pow(u, power);
    first = std::copysign(power * std::pow(u, power - 1.0) / semi_axis, x);
    second = power * (power - 1.0) * std::pow(std::max(u, nearest_to_zero), power - 2.0) / (semi_axis * semi_axis);
  }
  double value;
  double first;
  double second;
};

}  // namespace

ImplicitSuperquadric::ImplicitSuperquadric(const Superquadric& solid)
    : solid_(solid), section_power_(2.0 / solid.exponents[1]), profile_power_(2.0 / solid.exponents[0]) {}

double ImplicitSuperquadric::value(const Eigen::Vector3d& x) const {
  const auto& [a1, a2, a3] = solid_.semi_axes;
  const double section = std::pow(std::abs(x[0]) / a1, section_power_) + std::pow(std::abs(x[1]) / a2, section_power_);
  return std::pow(section, profile_power_ / section_power_) + std::pow(std::abs(x[2]) / a3, profile_power_);
}

Eigen::Vector3d ImplicitSuperquadric::gradient(const Eigen::Vector3d& x) const {
  const auto& [a1, a2, a3] = solid_.semi_axes;
  const Power along_x(x[0], a1, section_power_);
  const Power along_y(x[1], a2, section_power_);
  const Power along_z(x[2], a3, profile_power_);
  const double section = along_x.value + along_y.value;
  const double outer = profile_power_ / section_power_;
  const double by_section = section == 0.0 ? 0.0 : outer * std::pow(section, outer - 1.0);
  return {by_section * along_x.first, by_section * along_y.first, along_z.first};
}

Eigen::Matrix3d ImplicitSuperquadric::hessian(const Eigen::Vector3d& x) const {
  const auto& [a1, a2, a3] = solid_.semi_axes;
  const Power along_x(x[0], a1, section_power_);
  const Power along_y(x[1], a2, section_power_);
  const Power along_z(x[2], a3, profile_power_);
  const double section = along_x.value + along_y.value;
  const double outer = profile_power_ / section_power_;
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
  hessian(2, 2) = along_z.second;
  if (section == 0.0) return hessian;
  const double by_section = outer * std::pow(section, outer - 1.0);
  const double by_section_twice = (outer - 1.0) * by_section / section;
  const Eigen::Vector2d slope(along_x.first, along_y.first);
  hessian.topLeftCorner<2, 2>() = by_section_twice * slope * slope.transpose();
  hessian(0, 0) += by_section * along_x.second;
  hessian(1, 1) += by_section * along_y.second;
  return hessian;
}

Eigen::Vector3d ImplicitSuperquadric::interior_point(const Eigen::Vector3d& direction) const {
  Eigen::Vector3d x = 0.5 / approximate_gauge(solid_, point(direction)) * direction;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double least = off_the_planes * solid_.semi_axes[static_cast<std::size_t>(axis)];
    x[axis] = std::copysign(std::max(std::abs(x[axis]), least), x[axis]);
  }
  return x;
}

}  // namespace verisq::bench
