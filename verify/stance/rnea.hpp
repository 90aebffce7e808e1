/// Inverse dynamics by the recursive Newton-Euler algorithm, over any scalar (Featherstone, Rigid Body Dynamics
/// Algorithms, table 5.1).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "verify/stance/kinematics.hpp"
#include "verify/stance/tree.hpp"

namespace verisq::stance {

/// The generalised forces (N or N m, one a joint) that give the joints these accelerations in gravity, without contact
/// and applied force: M(q) acceleration + h(q, velocity).
template <class T>
[[nodiscard]] std::vector<T> inverse_dynamics(const Model& model, std::span<const T> parameters, const State<T>& state,
                                              std::span<const T> acceleration) {
  const Tree<T> tree = tree_of(model, parameters, state.position);
  const std::size_t count = tree.links.size();
  // A tree that accelerates upwards feels gravity.
  SpatialMotion<T> world;
  world.linear[1] = T(model.gravity);
  std::vector<SpatialMotion<T>> v(count);
  std::vector<SpatialMotion<T>> a(count);
  std::vector<Force<T>> f(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Link<T>& link = tree.links[i];
    const SpatialMotion<T> carried = link.parent ? v[*link.parent] : SpatialMotion<T>{};
    v[i] = link.transform.to_child(carried);
    a[i] = link.transform.to_child(link.parent ? a[*link.parent] : world);
    if (link.joint != nullptr) {
      const SpatialMotion<T> relative = link.joint_motion(state.velocity[link.degree_of_freedom]);
      v[i] = v[i] + relative;
      a[i] = a[i] + link.joint_motion(acceleration[link.degree_of_freedom]) + cross(v[i], relative);
    }
    f[i] = link.inertia * a[i] + cross(v[i], link.inertia * v[i]);
  }
  std::vector<T> generalised(tree.degrees_of_freedom, T(0));
  for (std::size_t i = count; i-- > 0;) {
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
