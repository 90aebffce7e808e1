/// Forward kinematics: where a model's bodies are, how their points move, and what a force on a point does to the
/// joints, over any scalar.
#pragma once

#include <span>
#include <vector>

#include "verify/stance/tree.hpp"

namespace verisq::stance {

/// Of a body's frame in the world.
template <class T>
struct BodyPose {
  Matrix3<T> orientation;  ///< columns are the body's axes
  Vector3<T> position;     ///< of its origin, m

  [[nodiscard]] Vector3<T> point(const Vector3<T>& in_body) const { return position + orientation * in_body; }
};

namespace kinematics_details {

template <class T>
[[nodiscard]] BodyPose<T> composed(const BodyPose<T>& parent, const Transform<T>& transform) {
  BodyPose<T> pose = parent;
  if (transform.shift) pose.position += parent.orientation * *transform.shift;
  if (transform.turn) {
    for (int i = 0; i < 3; ++i) {
      const Vector3<T> row = parent.orientation.row(i).transpose();
      pose.orientation.row(i) = transform.to_child(row).transpose();
    }
  }
  return pose;
}

template <class T>
[[nodiscard]] std::vector<BodyPose<T>> link_poses(const Tree<T>& tree) {
  const BodyPose<T> world{Matrix3<T>::Identity(), zero_vector<T>()};
  std::vector<BodyPose<T>> poses;
  poses.reserve(tree.links.size());
  for (const Link<T>& link : tree.links) {
    poses.push_back(composed(link.parent ? poses[*link.parent] : world, link.transform));
  }
  return poses;
}

}  // namespace kinematics_details

/// One pose a body.
template <class T>
[[nodiscard]] std::vector<BodyPose<T>> forward_kinematics(const Tree<T>& tree) {
  const std::vector<BodyPose<T>> links = kinematics_details::link_poses(tree);
  std::vector<BodyPose<T>> poses;
  for (const std::size_t link : tree.body_link) poses.push_back(links[link]);
  return poses;
}

/// The velocities of the bodies in their own frames: angular, and of their origins.
template <class T>
[[nodiscard]] std::vector<SpatialMotion<T>> body_velocities(const Tree<T>& tree, const std::vector<T>& velocity) {
  std::vector<SpatialMotion<T>> links;
  for (const Link<T>& link : tree.links) {
    SpatialMotion<T> v = link.parent ? link.transform.to_child(links[*link.parent]) : SpatialMotion<T>{};
    if (link.joint != nullptr) v = v + link.joint_motion(velocity[link.degree_of_freedom]);
    links.push_back(v);
  }
  std::vector<SpatialMotion<T>> bodies;
  for (const std::size_t link : tree.body_link) bodies.push_back(links[link]);
  return bodies;
}

/// The velocity in the world of a body's point.
template <class T>
[[nodiscard]] Vector3<T> point_velocity(const BodyPose<T>& pose, const SpatialMotion<T>& body_velocity,
                                        const Vector3<T>& point_in_body) {
  return pose.orientation * Vector3<T>(body_velocity.linear + body_velocity.angular.cross(point_in_body));
}

/// What a wrench on a body, in the body's frame, is to the joints: one number each.
template <class T>
[[nodiscard]] std::vector<T> generalised_force(const Tree<T>& tree, std::size_t body, Force<T> wrench) {
  std::vector<T> result(tree.degrees_of_freedom, T(0));
  for (std::optional<std::size_t> i = tree.body_link[body]; i; i = tree.links[*i].parent) {
    const Link<T>& link = tree.links[*i];
    if (link.joint != nullptr) result[link.degree_of_freedom] = link.joint_force(wrench);
    wrench = link.transform.to_parent(wrench);
  }
  return result;
}

/// The transpose of a point's Jacobian times a force in the world's axes on that point of a body.
template <class T>
[[nodiscard]] std::vector<T> generalised_force(const Tree<T>& tree, std::size_t body, const Vector3<T>& point_in_body,
                                               const Vector3<T>& force) {
  const Matrix3<T> orientation = forward_kinematics(tree)[body].orientation;
  const Vector3<T> in_body = orientation.transpose() * force;
  return generalised_force(tree, body, Force<T>{point_in_body.cross(in_body), in_body});
}

}  // namespace verisq::stance
