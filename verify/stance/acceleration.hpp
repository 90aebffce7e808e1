/// Accelerations of a body, free or on the ground.
#pragma once

#include <Eigen/Core>
#include <Eigen/Dense>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <optional>
#include <vector>
#include <verisq/stance.hpp>

#include "verify/stance/equilibrium_location.hpp"
#include "verify/stance/linear_systems.hpp"
#include "verify/stance/reduced_motion.hpp"
#include "verify/stance/rnea.hpp"
#include "verify/stance/standing.hpp"

namespace verisq::stance {

// The equations of motion at an instant, M(q) acceleration = force, under gravity, the applied force at t = 0 and what
// the instant says, over any scalar.

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

// All joint accelerations over one box of parameters, by the parametric linear system of the equations of motion.

/// What is proven of the accelerations over a box.
struct AccelerationCell {
  /// And their derivatives by each variable, 0 where that is a point of the box. Nothing where it is not proven that
  /// every mass matrix is regular.
  std::optional<ParametricSolution> accelerations;
  /// By variable, where nothing is proven: how much it is in the way.
  std::vector<double> obstructions;
  std::optional<Eigen::VectorXd> sample;  ///< near the middle, in plain floating point
};

class AccelerationProblem {
 public:
  /// Over parts of `whole`. Model and instant must outlive the problem.
  AccelerationProblem(const Model& model, const Instant& at, const Box& whole, UncertainSet uncertain);

  /// Those of the uncertain set by which the equations of motion may change over the box; for all others the derivative
  /// is proven to be 0.
  [[nodiscard]] const std::vector<std::uint32_t>& variables() const { return variables_; }

  [[nodiscard]] AccelerationCell examine(const Box& box) const;

 private:
  const Model& model_;
  const Instant& at_;
  std::vector<std::uint32_t> variables_;
  std::optional<ReducedMotion> reduced_;
};

}  // namespace verisq::stance
