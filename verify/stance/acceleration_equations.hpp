/// The equations of motion of the analysed stance, M(q) acceleration = force, under gravity and the applied force at
/// t = 0, over any scalar.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "verify/stance/crba.hpp"
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

template <class T>
[[nodiscard]] Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic> stance_mass_matrix(const Model& model,
                                                                                  const std::vector<T>& parameters) {
  return mass_matrix<T>(model, parameters, stance_state<T>(model));
}

/// force - M(q) acceleration: what is missing for the joints to accelerate like this. By one recursion, in which the
/// acceleration and gravity meet before any parameter does: a nearly free fall leaves nearly nothing.
template <class T>
[[nodiscard]] Eigen::Matrix<T, Eigen::Dynamic, 1> residual_force(const Model& model, const std::vector<T>& parameters,
                                                                 const Eigen::VectorXd& acceleration) {
  const State<T> state = stance_state<T>(model);
  const std::vector<T> applied = applied_generalised_force(model, parameters, state);
  std::vector<T> accelerations;
  for (const double a : acceleration) accelerations.push_back(T(a));
  const std::vector<T> needed = inverse_dynamics<T>(model, parameters, state, accelerations);
  Eigen::Matrix<T, Eigen::Dynamic, 1> residual(acceleration.size());
  for (std::size_t i = 0; i < needed.size(); ++i) residual[static_cast<Eigen::Index>(i)] = applied[i] - needed[i];
  return residual;
}

/// In plain floating point.
[[nodiscard]] inline Eigen::VectorXd approximate_accelerations(const Model& model,
                                                               const std::vector<double>& parameters) {
  const Eigen::MatrixXd mass = stance_mass_matrix(model, parameters);
  return mass.ldlt().solve(residual_force(model, parameters, Eigen::VectorXd::Zero(mass.rows())));
}

}  // namespace verisq::stance
