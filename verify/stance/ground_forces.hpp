/// What the ground does to the cylinders of a body at rest, over any scalar (docs/stance.md §7).
#pragma once

#include <span>
#include <vector>

#include "verify/stance/contact.hpp"
#include "verify/stance/standing_equations.hpp"

namespace verisq::stance {

/// The ground's force at a place on a cylinder's axis, vertical because the bristles of a body at rest are not
/// stretched yet: `upward` times what a newton of it is at the origin of the cylinder's body, in the body's frame. The
/// disc's lowest point lies off its centre along the axis by the radius times the axis's lean; what it lies below the
/// centre is along the force.
template <class T>
struct GroundForce {
  T upward;            ///< N, never below 0
  Force<T> at_centre;  ///< of 1 N at the disc's centre
  Force<T> by_radius;  ///< what the lean adds, by m of radius
};

/// Of half of the stiffness at each of Gauss's two points. Where the axis is exactly level, both are pressed alike: all
/// of it at the middle is the same wrench, and intervals do not take the two forces for different ones. A cylinder
/// whose axis may be vertical divides by 0: std::domain_error over intervals.
template <class T>
[[nodiscard]] std::vector<GroundForce<T>> ground_forces(const ContactCylinder& cylinder, const BodyPose<T>& pose,
                                                        std::span<const T> parameters) {
  const Vector3<T> up = pose.orientation.row(1).transpose();
  const Vector3<T> axis = standing_details::exact<T>(cylinder.axis);
  const T rise = up.dot(axis);
  const bool level = is_zero(rise);
  const std::vector<double> sides = level ? std::vector<double>{0.0} : std::vector<double>{-1.0, 1.0};
  const T s = level ? T(1) : T(sqrt(T(T(1) - square(rise))));
  const T radius = value_of<T>(cylinder.radius, parameters);
  // At rest the damped law is the elastic one, whatever the restitution is.
  const HuntCrossley<T> law{value_of<T>(cylinder.stiffness, parameters) / T(static_cast<double>(sides.size())),
                            cylinder.exponent, T(0), T(1)};
  std::vector<GroundForce<T>> forces;
  for (const double side : sides) {
    const Vector3<T> centre = standing_details::gauss_point<T>(cylinder, parameters, side);
    const T height = pose.position[1] + up.dot(centre);
    forces.push_back({normal_force(law, T(radius * s - height), T(0)),
                      {centre.cross(up), up},
                      {Vector3<T>((rise / s) * Vector3<T>(axis.cross(up))), zero_vector<T>()}});
  }
  return forces;
}

/// Of all cylinders, on the joints: one number each.
template <class T>
[[nodiscard]] std::vector<T> ground_generalised_force(const Model& model, const std::vector<T>& parameters,
                                                      const Tree<T>& tree) {
  const std::vector<BodyPose<T>> poses = forward_kinematics(tree);
  std::vector<T> result(tree.degrees_of_freedom, T(0));
  for (const ContactCylinder& cylinder : model.cylinders) {
    const T radius = value_of<T>(cylinder.radius, std::span<const T>(parameters));
    for (const GroundForce<T>& point : ground_forces<T>(cylinder, poses[cylinder.body], parameters)) {
      const Force<T> unit{point.at_centre.moment + radius * point.by_radius.moment, point.at_centre.force};
      const std::vector<T> part = generalised_force(tree, cylinder.body, unit);
      for (std::size_t i = 0; i < part.size(); ++i) result[i] += point.upward * part[i];
    }
  }
  return result;
}

}  // namespace verisq::stance
