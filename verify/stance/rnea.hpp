/// Kinematics, RNEA and CRBA.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <span>
#include <vector>

#include "verify/stance/tree.hpp"

namespace verisq::stance {

// Forward kinematics: where a model's bodies are, how their points move, and what a force on a point does to the
// joints, over any scalar.

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

// Inverse dynamics by the recursive Newton-Euler algorithm, over any scalar (Featherstone, Rigid Body Dynamics
// Algorithms, table 5.1).

/// How a link moves, in its own frame.
template <class T>
struct LinkMotion {
  SpatialMotion<T> velocity, acceleration;
};

/// Of all links. The world accelerates upwards by gravity: a tree in such a world feels its weight.
template <class T>
[[nodiscard]] std::vector<LinkMotion<T>> link_motions(const Tree<T>& tree, double gravity,
                                                      const std::vector<T>& velocity, std::span<const T> acceleration) {
  LinkMotion<T> world;
  world.acceleration.linear[1] = T(gravity);
  std::vector<LinkMotion<T>> motions;
  motions.reserve(tree.links.size());
  for (const Link<T>& link : tree.links) {
    const LinkMotion<T>& carrier = link.parent ? motions[*link.parent] : world;
    LinkMotion<T> motion{link.transform.to_child(carrier.velocity), link.transform.to_child(carrier.acceleration)};
    if (link.joint != nullptr) {
      const SpatialMotion<T> relative = link.joint_motion(velocity[link.degree_of_freedom]);
      motion.velocity = motion.velocity + relative;
      motion.acceleration = motion.acceleration + link.joint_motion(acceleration[link.degree_of_freedom]) +
                            cross(motion.velocity, relative);
    }
    motions.push_back(motion);
  }
  return motions;
}

/// The generalised forces (N or N m, one a joint) that give the joints these accelerations in gravity, without contact
/// and applied force: M(q) acceleration + h(q, velocity).
template <class T>
[[nodiscard]] std::vector<T> inverse_dynamics(const Model& model, std::span<const T> parameters, const State<T>& state,
                                              std::span<const T> acceleration) {
  const Tree<T> tree = tree_of(model, parameters, state.position);
  std::vector<Force<T>> f;
  f.reserve(tree.links.size());
  const std::vector<LinkMotion<T>> motions = link_motions(tree, model.gravity, state.velocity, acceleration);
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const auto& [v, a] = motions[i];
    const Inertia<T>& inertia = tree.links[i].inertia;
    f.push_back(inertia * a + cross(v, inertia * v));
  }
  std::vector<T> generalised(tree.degrees_of_freedom, T(0));
  for (std::size_t i = f.size(); i-- > 0;) {
    const Link<T>& link = tree.links[i];
    if (link.joint != nullptr) generalised[link.degree_of_freedom] = link.joint_force(f[i]);
    if (link.parent) f[*link.parent] = f[*link.parent] + link.transform.to_parent(f[i]);
  }
  return generalised;
}

/// h(q, velocity): gravity, centrifugal and Coriolis forces.
template <class T>
[[nodiscard]] std::vector<T> bias_forces(const Model& model, std::span<const T> parameters, const State<T>& state) {
  const std::vector<T> none(state.position.size(), T(0));
  return inverse_dynamics<T>(model, parameters, state, none);
}

/// The wrench of gravity and of the applied force at t = 0 on the tree at rest, in the order of stance_analysis.hpp, in
/// the world's axes. Moments are about the root's reference point: the world's origin, which the root's translations
/// carry along; there the applied force acts. Unlike the recursion, which moves moments from frame to frame and so
/// meets a mass twice, this takes each body's weight at its centre of mass: every parameter occurs once a component, as
/// long as the tree stands upright (docs/stance.md §3). Precondition: the model has a root.
template <class T>
[[nodiscard]] std::array<T, wrench_size> root_wrench(const Model& model, std::span<const T> parameters,
                                                     const State<T>& state) {
  State<T> carried = state;
  const std::vector<Joint>& joints = model.bodies.front().joints;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (joints[j].kind == JointKind::translation) carried.position[j] = T(0);
  }
  const std::vector<BodyPose<T>> poses = forward_kinematics(tree_of(model, parameters, carried.position));
  T mass(0);
  T moment_x(0);
  T moment_z(0);
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const Body& body = model.bodies[i];
    const T body_mass = value_of(body.mass, parameters);
    const Vector3<T> centre = poses[i].point(values_of(body.centre_of_mass, parameters));
    mass += body_mass;
    moment_x += body_mass * centre[2];
    moment_z -= body_mass * centre[0];
  }
  const T gravity(model.gravity);
  const Vector3<T> applied = values_of(model.applied.force, parameters);
  return {applied[0], applied[1] - gravity * mass, applied[2], gravity * moment_x, T(0), gravity * moment_z};
}

// The mass matrix by the composite-rigid-body algorithm, over any scalar (Featherstone, Rigid Body Dynamics
// Algorithms, table 6.2).

/// M(q): symmetric, one row a joint. Entries between joints of different branches are exactly 0.
template <class T>
[[nodiscard]] Eigen::Matrix<T, -1, -1> mass_matrix(const Model& model, std::span<const T> parameters,
                                                   const State<T>& state) {
  const Tree<T> tree = tree_of(model, parameters, state.position);
  const auto size = static_cast<Eigen::Index>(tree.degrees_of_freedom);
  Eigen::Matrix<T, -1, -1> matrix = Eigen::Matrix<T, -1, -1>::Constant(size, size, T(0));
  std::vector<Inertia<T>> composite;
  composite.reserve(tree.links.size());
  for (const Link<T>& link : tree.links) composite.push_back(link.inertia);
  for (std::size_t i = tree.links.size(); i-- > 0;) {
    const Link<T>* link = &tree.links[i];
    if (link->parent) {
      Inertia<T>& carrier = composite[*link->parent];
      carrier = carrier + link->transform.to_parent(composite[i]);
    }
    if (link->joint == nullptr) continue;
    const auto row = static_cast<Eigen::Index>(link->degree_of_freedom);
    Force<T> f = composite[i] * link->joint_motion(T(1));
    matrix(row, row) = link->joint_force(f);
    while (link->parent) {
      f = link->transform.to_parent(f);
      link = &tree.links[*link->parent];
      if (link->joint == nullptr) continue;
      const auto column = static_cast<Eigen::Index>(link->degree_of_freedom);
      // NOLINTNEXTLINE(readability-suspicious-call-argument): the matrix is symmetric
      matrix(row, column) = matrix(column, row) = link->joint_force(f);
    }
  }
  return matrix;
}

}  // namespace verisq::stance
