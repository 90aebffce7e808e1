/// The equations of motion at an instant, M(q) acceleration = force, under gravity, the applied force at t = 0 and what
/// the instant says, over any scalar.
#pragma once

#include <Eigen/Dense>
#include <concepts>
#include <cstddef>
#include <numeric>
#include <vector>
#include <verisq/stance_analysis.hpp>

#include "verify/stance/crba.hpp"
#include "verify/stance/ground_forces.hpp"
#include "verify/stance/rnea.hpp"

namespace verisq::stance {

/// What the applied force does to the joints. It acts at the root's reference point, as in `root_wrench`.
template <class T>
[[nodiscard]] std::vector<T> applied_generalised_force(const Model& model, const std::vector<T>& parameters,
                                                       const State<T>& state) {
  State<T> carried = state;
  const std::vector<Joint>& joints = model.bodies.front().joints;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (joints[j].kind == JointKind::translation) carried.position[j] = T(0);
  }
  // Carried back to the world's origin, the root has the reference point there.
  const Tree<T> tree = tree_of<T>(model, parameters, carried.position);
  const BodyPose<T> root = forward_kinematics(tree).front();
  const Vector3<T> reference = -(root.orientation.transpose() * root.position);
  return generalised_force<T>(tree, 0, reference, values_of<T>(model.applied.force, parameters));
}

/// All numbers of the enclosure, or one near the middle where the scalar is a number.
template <class T>
[[nodiscard]] T constant_of(const Enclosure& numbers) {
  if constexpr (std::same_as<T, double>)
    return std::midpoint(numbers.lo, numbers.hi);
  else
    return T(Interval(numbers.lo, numbers.hi));
}

template <class T>
[[nodiscard]] State<T> state_at(const Instant& at) {
  State<T> state;
  for (const Enclosure& position : at.positions) state.position.push_back(constant_of<T>(position));
  state.velocity.assign(at.velocities.begin(), at.velocities.end());
  return state;
}

/// What the instant's torques, the ground and the applied force do to the joints.
template <class T>
[[nodiscard]] std::vector<T> given_generalised_force(const Model& model, const std::vector<T>& parameters,
                                                     const Instant& at, const State<T>& state) {
  std::vector<T> result = applied_generalised_force(model, parameters, state);
  for (std::size_t i = 0; i < result.size(); ++i) result[i] += constant_of<T>(at.torques[i]);
  if (!at.on_ground) return result;
  const std::vector<T> ground =
      ground_generalised_force(model, parameters, tree_of<T>(model, parameters, state.position));
  for (std::size_t i = 0; i < result.size(); ++i) result[i] += ground[i];
  return result;
}

template <class T>
[[nodiscard]] Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic> mass_matrix_at(const Model& model,
                                                                              const std::vector<T>& parameters,
                                                                              const Instant& at) {
  return mass_matrix<T>(model, parameters, state_at<T>(at));
}

/// force - M(q) acceleration: what is missing for the joints to accelerate like this. By one recursion, in which the
/// acceleration and gravity meet before any parameter does: a nearly free fall leaves nearly nothing.
template <class T>
[[nodiscard]] Eigen::Matrix<T, Eigen::Dynamic, 1> residual_force(const Model& model, const std::vector<T>& parameters,
                                                                 const Instant& at,
                                                                 const Eigen::VectorXd& acceleration) {
  const State<T> state = state_at<T>(at);
  const std::vector<T> given = given_generalised_force(model, parameters, at, state);
  std::vector<T> accelerations;
  for (const double a : acceleration) accelerations.push_back(T(a));
  const std::vector<T> needed = inverse_dynamics<T>(model, parameters, state, accelerations);
  Eigen::Matrix<T, Eigen::Dynamic, 1> residual(acceleration.size());
  for (std::size_t i = 0; i < needed.size(); ++i) residual[static_cast<Eigen::Index>(i)] = given[i] - needed[i];
  return residual;
}

/// In plain floating point.
[[nodiscard]] inline Eigen::VectorXd approximate_accelerations(const Model& model, const Instant& at,
                                                               const std::vector<double>& parameters) {
  const Eigen::MatrixXd mass = mass_matrix_at(model, parameters, at);
  return mass.ldlt().solve(residual_force(model, parameters, at, Eigen::VectorXd::Zero(mass.rows())));
}

}  // namespace verisq::stance
