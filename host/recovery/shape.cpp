/// From a model's primitive to the parameters of the search, and back.
#include "host/recovery/shape.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

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
  const auto& [w, x, y, z] = primitive.pose.quaternion;
  const double taper = primitive.superquadric.taper;
  Shape shape{.centre = Eigen::Vector3d(primitive.pose.translation.data()),
              .rotation = Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix(),
              .axes = Eigen::Vector3d(primitive.superquadric.semi_axes.data()),
              .exponents = Eigen::Vector2d(primitive.superquadric.exponents.data()),
              .taper = (taper - 1.0) / (taper + 1.0)};
  if (primitive.bend) {
    const double angle = primitive.bend->angle_degrees * std::numbers::pi / 180.0;
    shape.curvature = primitive.bend->curvature * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  }
  return shape;
}

}  // namespace verisq::recovery
