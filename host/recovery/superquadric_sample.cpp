/// Rejection from a uniform direction u of the unit sphere: the point s u, s = 1/gauge(u), of the surface scaled to
/// semi-axes 1 stands for the area a1 a2 a3 s^3 |A^-1 gradient| of the shape, A the diagonal matrix of the semi-axes.
#include "host/recovery/superquadric_sample.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/recovery/surface_distance.hpp"

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

/// Of the straight solid of Eq. (1), in its own frame.
Eigen::Vector3d deformed(const Eigen::Vector3d& point, const Shape& shape) {
  const double k = shape.taper;
  const double height = point[2] / shape.axes[2];
  const double moved = (height - k) / (1.0 - k * height);  // z'/a3 of Superquadric's comment
  const double scale = 1.0 + k * moved;
  const Eigen::Vector3d tapered(scale * point[0], scale * point[1], shape.axes[2] * moved);
  const double curvature = shape.curvature.norm();
  if (curvature == 0.0) return tapered;
  const Eigen::Vector2d direction = shape.curvature / curvature;
  const double r = direction.dot(tapered.head<2>());
  const double s = direction[0] * tapered[1] - direction[1] * tapered[0];
  const double radius = 1.0 / curvature - r;
  const double bent_r = 1.0 / curvature - radius * std::cos(curvature * tapered[2]);
  return {direction[0] * bent_r - direction[1] * s, direction[1] * bent_r + direction[0] * s,
          radius * std::sin(curvature * tapered[2])};
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
    points.push_back(shape.centre + shape.rotation * deformed((s * direction).cwiseProduct(shape.axes), shape));
  }
  return points;
}

std::vector<Eigen::Vector3d> sample_union(std::span<const Shape> shapes, std::size_t count, std::mt19937_64& random) {
  std::vector<DistanceToShape> distances;
  for (const Shape& shape : shapes) distances.emplace_back(shape, Family::plain);
  double total = 0.0;
  const auto area = [](const Shape& shape) {
    return shape.axes[0] * shape.axes[1] + shape.axes[1] * shape.axes[2] + shape.axes[2] * shape.axes[0];
  };
  for (const Shape& shape : shapes) total += area(shape);
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const auto share = static_cast<std::size_t>(std::ceil(static_cast<double>(count) * area(shapes[i]) / total));
    for (const Eigen::Vector3d& point : sample_surface(shapes[i], share, random)) {
      bool covered = false;
      for (std::size_t j = 0; j < shapes.size() && !covered; ++j) covered = j != i && distances[j].value(point) < 0.0;
      if (!covered) points.push_back(point);
    }
  }
  return points;
}

}  // namespace verisq::recovery
