/// Rejection from a uniform direction u of the unit sphere: the point s u, s = 1/gauge(u), of the surface scaled to
/// semi-axes 1 stands for the area a1 a2 a3 s^3 |A^-1 gradient| of the shape, A the diagonal matrix of the semi-axes.
#include "host/recovery/superquadric_sample.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace verisq::recovery {
namespace {

/// Gauge of semi-axes 1, and its gradient.
double unit_gauge(const Eigen::Vector3d& point, const Eigen::Vector2d& exponents, Eigen::Vector3d& gradient) {
  const Eigen::Vector3d size = point.cwiseAbs().cwiseMax(1e-30);
  const auto norm = [](double a, double b, double power, double& by_a, double& by_b) {
    const double larger = std::max(a, b);
    const double value = larger * std::pow(std::pow(a / larger, power) + std::pow(b / larger, power), 1.0 / power);
    by_a = std::pow(a / value, power - 1.0);
    by_b = std::pow(b / value, power - 1.0);
    return value;
  };
  double section_by_x = 0.0;
  double section_by_y = 0.0;
  double by_section = 0.0;
  const double section = norm(size[0], size[1], 2.0 / exponents[1], section_by_x, section_by_y);
  const double gauge = norm(section, size[2], 2.0 / exponents[0], by_section, gradient[2]);
  gradient[0] = by_section * section_by_x;
  gradient[1] = by_section * section_by_y;
  return gauge;
}

}  // namespace

std::vector<Eigen::Vector3d> sample_surface(const Shape& shape, std::size_t count, std::mt19937_64& random) {
  std::vector<Eigen::Vector3d> points;
  points.reserve(count);
  const Eigen::Vector3d reciprocal = shape.axes.cwiseInverse();
  // |s u| is at most sqrt 3, components of the gradient are at most 1.
  const double most = std::pow(3.0, 1.5) * reciprocal.norm();
  while (points.size() < count) {
    const double z = 2.0 * fraction(random) - 1.0;
    const double angle = 2.0 * std::numbers::pi * fraction(random);
    const double kept = fraction(random);
    const double radius = std::sqrt(std::max(0.0, 1.0 - z * z));
    const Eigen::Vector3d direction(radius * std::cos(angle), radius * std::sin(angle), z);
    Eigen::Vector3d gradient;
    const double s = 1.0 / unit_gauge(direction, shape.exponents, gradient);
    if (kept * most > s * s * s * gradient.cwiseProduct(reciprocal).norm()) continue;
    points.push_back(shape.centre + shape.rotation * (s * direction).cwiseProduct(shape.axes));
  }
  return points;
}

}  // namespace verisq::recovery
