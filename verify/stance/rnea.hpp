/// Inverse dynamics by the recursive Newton-Euler algorithm, over any scalar (Featherstone, Rigid Body Dynamics
/// Algorithms, table 5.1).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "verify/stance/kinematics.hpp"
#include "verify/stance/tree.hpp"

namespace verisq::stance {

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

}  // namespace verisq::stance
