/// Relabelled, turned and shortened shapes.
#include "host/recovery/alternative_shapes.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>

namespace verisq::recovery {
namespace {

constexpr double most_pointed = 1.99;  // at 2 itself nothing is smooth
constexpr double inlier = 3.0;         // so many times the noise from the surface at most
constexpr double filled = 0.9;         // of an axis, by points: then there is no shorter shape

/// The diagonal of the section becomes an axis: at 45 degrees a superellipse of semi-axis a reaches a sqrt 2 2^(-e/2).
Shape turned(Shape shape) {
  shape.rotation =
      shape.rotation * Eigen::AngleAxisd(0.25 * std::numbers::pi, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const double diagonal = std::sqrt(2.0 * shape.axes[0] * shape.axes[1]) * std::exp2(-0.5 * shape.exponents[1]);
  shape.axes[0] = shape.axes[1] = diagonal;
  shape.exponents[1] = 2.0 - shape.exponents[1];
  return shape;
}

/// The axis of that index becomes z, and the exponents change places.
Shape relabelled(const Shape& shape, int z) {
  Shape result = shape;
  const int x = (z + 1) % 3;
  const int y = (z + 2) % 3;
  result.rotation << shape.rotation.col(x), shape.rotation.col(y), shape.rotation.col(z);
  result.axes = {shape.axes[x], shape.axes[y], shape.axes[z]};
  result.exponents = {shape.exponents[1], shape.exponents[0]};
  result.taper = 0.0;
  result.curvature.setZero();
  return result;
}

void add_shorter(const MixtureFit& fit, std::span<const Eigen::Vector3d> points, std::vector<Shape>& shapes) {
  const Shape& shape = fit.shape;
  const DistanceToShape distance(shape, Family::plain);
  Eigen::Vector3d lowest = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d highest = -lowest;
  for (const Eigen::Vector3d& point : points) {
    if (std::abs(distance.value(point)) > inlier * fit.mixture.noise) continue;
    const Eigen::Vector3d local = shape.rotation.transpose() * (point - shape.centre);
    lowest = lowest.cwiseMin(local);
    highest = highest.cwiseMax(local);
  }
  for (int i = 0; i < 3; ++i) {
    const double half = 0.5 * (highest[i] - lowest[i]);
    if (!(half > 0.0) || half > filled * shape.axes[i]) continue;
    Shape ended = shape;
    ended.axes[i] = half;
    ended.centre += shape.rotation.col(i) * (0.5 * (highest[i] + lowest[i]));
    Shape half_way = shape;
    half_way.axes[i] = 0.5 * (half + shape.axes[i]);
    half_way.centre = 0.5 * (ended.centre + shape.centre);
    shapes.push_back(ended);
    shapes.push_back(half_way);
  }
}

}  // namespace

std::vector<Shape> alternative_shapes(const MixtureFit& fit, std::span<const Eigen::Vector3d> points) {
  std::vector<Shape> shapes{turned(fit.shape)};
  for (int z = 0; z < 2; ++z) {
    shapes.push_back(relabelled(fit.shape, z));
    shapes.push_back(turned(shapes.back()));
    shapes.push_back(relabelled(shapes.front(), z));
  }
  for (Shape& shape : shapes) shape.exponents = shape.exponents.cwiseMax(smallest_exponent).cwiseMin(most_pointed);
  add_shorter(fit, points, shapes);
  return shapes;
}

}  // namespace verisq::recovery
