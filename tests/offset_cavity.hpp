/// Cavities made from an implant: points at a given distance from its surface.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "verify/proof/boundary.hpp"
#include "verisq/cavity.hpp"
#include "verisq/model.hpp"
#include "verisq/signed_distance.hpp"

namespace verisq::testing {

/// A point of the surface moved by `gap` along its normal is exactly so far from a convex solid.
inline Point offset_point(const Primitive& primitive, double gap, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const auto& [a1, a2, a3] = primitive.superquadric.semi_axes;
  const Eigen::Vector3d direction = Eigen::Vector3d(normal(random), normal(random), normal(random))
                                        .normalized()
                                        .cwiseProduct(Eigen::Vector3d(a1, a2, a3));
  const verify::Boundary<double> boundary(primitive.superquadric);
  std::array<double, 3> surface{std::fabs(direction[0]), std::fabs(direction[1]), std::fabs(direction[2])};
  const double gauge = boundary.gauge(surface);
  for (double& x : surface) x /= gauge;
  const std::array<double, 3> outward = boundary.normal(surface);
  Eigen::Vector3d local;
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    local[i] = std::copysign(surface[k] + gap * outward[k], direction[i]);
  }
  const auto& [w, x, y, z] = primitive.pose.quaternion;
  const auto& [tx, ty, tz] = primitive.pose.translation;
  const Eigen::Vector3d p = Eigen::Quaterniond(w, x, y, z).normalized() * local + Eigen::Vector3d(tx, ty, tz);
  return {p[0], p[1], p[2]};
}

/// All around the union: up to `each` points a primitive, less those that another primitive is closer to.
inline Cavity offset_cavity(const Model& implant, double gap, std::size_t each) {
  std::mt19937_64 random(7);
  const SignedDistance distance(implant);
  Cavity cavity{{}, {{"all", 1.0}}, {}};
  for (const Primitive& primitive : implant.primitives) {
    for (std::size_t i = 0; i < each; ++i) {
      const Point point = offset_point(primitive, gap, random);
      if (distance(point, 1e-9).hi >= gap - 1e-6) cavity.points.push_back(point);
    }
  }
  cavity.area_of.assign(cavity.points.size(), 0);
  return cavity;
}

}  // namespace verisq::testing
