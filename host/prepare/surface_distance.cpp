/// This file implements surface_distance.hpp.
#include "host/prepare/surface_distance.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "verify/search/distance_field.hpp"

namespace verisq::recovery {

Primitive primitive_of(const Shape& shape, const std::string& name) {
  const Eigen::Quaterniond turn(shape.rotation);
  Primitive primitive{.name = name,
                      .superquadric = {.semi_axes = {shape.axes[0], shape.axes[1], shape.axes[2]},
                                       .exponents = {shape.exponents[0], shape.exponents[1]}},
                      .pose = {.translation = {shape.centre[0], shape.centre[1], shape.centre[2]},
                               .quaternion = {turn.w(), turn.x(), turn.y(), turn.z()}}};
  if (shape.taper != 0.0)
    primitive.superquadric.taper = std::clamp((1.0 + shape.taper) / (1.0 - shape.taper), smallest_taper, largest_taper);
  if (const double curvature = shape.curvature.norm(); curvature > 0.0)
    primitive.bend = Bend{curvature, std::atan2(shape.curvature[1], shape.curvature[0]) * 180.0 / std::numbers::pi};
  return primitive;
}

Model model_of(std::span<const Shape> shapes) {
  Model model;
  for (const Shape& shape : shapes)
    model.primitives.push_back(
        primitive_of(shape, shapes.size() == 1 ? "superquadric" : fmt::format("part{}", model.primitives.size() + 1)));
  return model;
}

Shape shape_of(const Primitive& primitive) {
  const double taper = primitive.superquadric.taper;
  Shape shape{.centre = Eigen::Vector3d(primitive.pose.translation.data()),
              .rotation = verify::unit_quaternion(primitive.pose.quaternion).toRotationMatrix(),
              .axes = Eigen::Vector3d(primitive.superquadric.semi_axes.data()),
              .exponents = Eigen::Vector2d(primitive.superquadric.exponents.data()),
              .taper = (taper - 1.0) / (taper + 1.0)};
  if (primitive.bend) {
    const double angle = primitive.bend->angle_degrees * std::numbers::pi / 180.0;
    shape.curvature = primitive.bend->curvature * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  }
  return shape;
}

namespace {

constexpr double tiny = 1e-30;            // no gradient is shorter
constexpr double straight_enough = 1e-9;  // curvature times distance: the bend's inverse is the identity to rounding
constexpr double most_taper =
    0.6;  // sections of the ends as 1 to 4: beyond, a solid is a cone far larger than what is seen

/// The point that a bend of curvature (kx, ky) takes to `bent` (Bend in include/verisq/model.hpp).
Eigen::Vector3d unbent(const Eigen::Vector3d& bent, const Eigen::Vector2d& curvature) {
  const double k = curvature.norm();
  if (k * bent.norm() < straight_enough) return bent;
  const Eigen::Vector2d direction = curvature / k;
  const double r = direction[0] * bent[0] + direction[1] * bent[1];
  const double s = direction[0] * bent[1] - direction[1] * bent[0];
  const double square = (1.0 - k * r) * (1.0 - k * r) + k * k * bent[2] * bent[2];
  const double straight_r = (2.0 * r - k * (r * r + bent[2] * bent[2])) / (1.0 + std::sqrt(square));
  const double straight_z = std::atan2(k * bent[2], 1.0 - k * r) / k;
  return {direction[0] * straight_r - direction[1] * s, direction[1] * straight_r + direction[0] * s, straight_z};
}

/// The gradient, at `bent`, of a function with the gradient `slope` at the straight point: lengths along the arc are
/// divided by 1 - k r, and the frame turns by k z.
Eigen::Vector3d bent_gradient(const Eigen::Vector3d& straight, const Eigen::Vector3d& slope,
                              const Eigen::Vector2d& curvature) {
  const double k = curvature.norm();
  if (k * straight.norm() < straight_enough) return slope;
  const Eigen::Vector2d direction = curvature / k;
  const double r = direction[0] * straight[0] + direction[1] * straight[1];
  const double along_r = direction[0] * slope[0] + direction[1] * slope[1];
  const double along_s = direction[0] * slope[1] - direction[1] * slope[0];
  const double along_arc = slope[2] / std::max(1.0 - k * r, 1e-3);
  const double cosine = std::cos(k * straight[2]);
  const double sine = std::sin(k * straight[2]);
  const double new_r = cosine * along_r + sine * along_arc;
  return {direction[0] * new_r - direction[1] * along_s, direction[1] * new_r + direction[0] * along_s,
          cosine * along_arc - sine * along_r};
}

}  // namespace

DistanceToShape::DistanceToShape(const Shape& shape, Family family)
    : shape_(shape), gauge_(shape), family_(family), bent_(bends(family) || !shape.curvature.isZero(0.0)) {}

double DistanceToShape::value(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d local = shape_.rotation.transpose() * (point - shape_.centre);
  const Eigen::Vector3d at = bent_ ? unbent(local, shape_.curvature) : local;
  const GaugeAt gauge = gauge_at<false>(gauge_, at[0], at[1], at[2]);
  if (!bent_) return gauge.value / gauge.length;
  return gauge.value / std::max(bent_gradient(at, {gauge.x, gauge.y, gauge.z}, shape_.curvature).norm(), tiny);
}

void DistanceToShape::evaluate(const Eigen::Vector3d& point, SurfaceDistance& distance) const {
  const Eigen::Vector3d local = shape_.rotation.transpose() * (point - shape_.centre);
  const Eigen::Vector3d at = bent_ ? unbent(local, shape_.curvature) : local;
  const GaugeAt gauge =
      bent_ ? gauge_at<false>(gauge_, at[0], at[1], at[2]) : gauge_at<true>(gauge_, at[0], at[1], at[2]);
  const Eigen::Vector3d straight(gauge.x, gauge.y, gauge.z);
  const Eigen::Vector3d gradient = bent_ ? bent_gradient(at, straight, shape_.curvature) : straight;
  const double scale = 1.0 / std::max(bent_ ? gradient.norm() : gauge.length, tiny);
  distance.value = gauge.value * scale;
  distance.derivatives.segment<3>(0) = -gradient * scale;
  distance.derivatives.segment<3>(3) = gradient.cross(local) * scale;
  distance.derivatives.segment<3>(6) = Eigen::Vector3d(gauge.by_x, gauge.by_y, gauge.by_z) * scale;
  distance.derivatives.segment<2>(9) = Eigen::Vector2d(gauge.by_along, gauge.by_section) * scale;
  distance.derivatives[11] = tapers(family_) ? gauge.by_taper * scale : 0.0;
  distance.derivatives.segment<2>(12).setZero();
  if (!bends(family_)) return;
  const double width = 1e-4 / (local.norm() + shape_.axes.maxCoeff());  // of the difference quotient
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector2d shift = width * Eigen::Vector2d::Unit(i);
    const Eigen::Vector3d by_curvature =
        (unbent(local, shape_.curvature + shift) - unbent(local, shape_.curvature - shift)) / (2.0 * width);
    distance.derivatives[12 + i] = straight.dot(by_curvature) * scale;
  }
}

Shape moved(const Shape& shape, const Step& step) {
  Shape result = shape;
  result.centre += shape.rotation * step.segment<3>(0);
  const Eigen::Vector3d turn = step.segment<3>(3);
  if (const double angle = turn.norm(); angle > 0.0)
    result.rotation = Eigen::Quaterniond(shape.rotation * Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix())
                          .normalized()
                          .toRotationMatrix();
  for (int i = 0; i < 3; ++i) result.axes[i] *= std::exp(step[6 + i]);
  for (int i = 0; i < 2; ++i)
    result.exponents[i] = std::clamp(shape.exponents[i] + step[9 + i], smallest_exponent, largest_exponent);
  result.taper = std::clamp(shape.taper + step[11], -most_taper, most_taper);
  result.curvature += step.segment<2>(12);
  return result;
}

}  // namespace verisq::recovery
