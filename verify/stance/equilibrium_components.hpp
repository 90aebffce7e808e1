/// What an equilibrium consists of as functions of its posture and the parameters, and their derivatives, over any
/// scalar (docs/stance.md §7).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "verify/stance/contraction.hpp"
#include "verify/stance/mean_value_range.hpp"
#include "verify/stance/standing_equations.hpp"
#include "verify/stance/standing_problem.hpp"

namespace verisq::stance {

/// The unknowns are the height of the reference point, then joints. An equilibrium's components are, one after the
/// other, what is missing for the balance (one an unknown, 0 in equilibrium) and penetrations (one a point); then
/// forces (one a cylinder), the centre of pressure's x and z, the root's translation along y, torques (one a joint).
enum class Extent : std::uint8_t { balance, all };

template <class T>
using Components = Eigen::Matrix<T, Eigen::Dynamic, 1>;

template <class T>
[[nodiscard]] StandingPosture<T> posture_of(const StandingProblem& problem, const std::vector<T>& unknowns) {
  StandingPosture<T> posture{unknowns.front(), {problem.positions.begin(), problem.positions.end()}};
  for (std::size_t i = 0; i < problem.joints.size(); ++i) posture.joints[problem.joints[i]] = unknowns[i + 1];
  return posture;
}

namespace components_details {

constexpr std::size_t turns_of_root = 2;

/// Forces upward, and moments about the reference point about z and -x.
template <class T>
struct Balance {
  T force = T(0);
  T moment_z = T(0);
  T moment_x = T(0);

  void add(const VerticalForce<T>& acting) {
    force += acting.upward;
    moment_z += acting.upward * acting.place[0];
    moment_x += acting.upward * acting.place[2];
  }
};

/// In the world, by the file's translations.
template <class T>
[[nodiscard]] Vector3<T> origin_of_root(const StandingProblem& problem, const std::vector<T>& parameters) {
  const Body& root = problem.model.bodies.front();
  Vector3<T> origin = values_of<T>(root.offset, parameters);
  for (std::size_t j = 0; j < root.joints.size(); ++j) {
    if (root.joints[j].kind == JointKind::translation) origin[root.joints[j].axis] += T(problem.positions[j]);
  }
  return origin;
}

template <class T>
[[nodiscard]] std::vector<Dual<T>> constants(const std::vector<T>& values) {
  return {values.begin(), values.end()};
}

template <class T>
[[nodiscard]] Components<T> partials(const Components<Dual<T>>& list) {
  return list.unaryExpr([](const Dual<T>& a) { return a.partial[0]; });
}

}  // namespace components_details

template <class T>
[[nodiscard]] Components<T> components(const StandingProblem& problem, const std::vector<T>& parameters,
                                       const std::vector<T>& unknowns, Extent extent) {
  using namespace components_details;
  const Model& model = problem.model;
  const StandingPosture<T> posture = posture_of(problem, unknowns);
  const bool with_torques = extent == Extent::all || problem.control == JointControl::proportional;
  const StandingTerms<T> terms = standing_terms<T>(model, parameters, posture, problem.reference, with_torques);
  Balance<T> carried;
  for (const VerticalForce<T>& weight : terms.weights) carried.add(weight);
  carried.add(terms.applied);
  Balance<T> all = carried;
  for (const PressedPoint<T>& point : terms.points) all.add(point.force);
  std::vector<T> list{all.force, all.moment_z, all.moment_x};
  for (std::size_t i = turns_of_root; i < problem.joints.size(); ++i) {
    const std::size_t joint = problem.joints[i];
    const T error = posture.joints[joint] - T(problem.positions[joint]);
    list.push_back(terms.torques[joint] + T(problem.stiffness[joint]) * error);
  }
  for (const PressedPoint<T>& point : terms.points) list.push_back(point.penetration);
  if (extent == Extent::all) {
    for (std::size_t c = 0; c < model.cylinders.size(); ++c) {
      T force(0);
      for (std::size_t i = 0; i < points_of_cylinder; ++i)
        force += terms.points[points_of_cylinder * c + i].force.upward;
      list.push_back(force);
    }
    // In equilibrium the ground's forces and moments are those that it carries, which stiffness has no part in.
    const Vector3<T> origin = origin_of_root(problem, parameters);
    list.push_back(origin[0] + terms.reference[0] + carried.moment_z / carried.force);
    list.push_back(origin[2] + terms.reference[2] + carried.moment_x / carried.force);
    list.push_back(terms.root_translation);
    list.insert(list.end(), terms.torques.begin(), terms.torques.end());
  }
  return Eigen::Map<const Components<T>>(list.data(), static_cast<Eigen::Index>(list.size()));
}

/// Of all components by one parameter.
[[nodiscard]] inline IntervalVector by_parameter(const StandingProblem& problem, const Box& parameters,
                                                 const std::vector<Interval>& unknowns, std::uint32_t parameter) {
  using namespace components_details;
  const std::vector<Dual<Interval>> variables = as_variables<1, Interval>(parameters, {parameter});
  return partials<Interval>(components<Dual<Interval>>(problem, variables, constants(unknowns), Extent::all));
}

/// Of all components by all unknowns.
template <class T>
[[nodiscard]] Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic> by_unknowns(const StandingProblem& problem,
                                                                           const std::vector<T>& parameters,
                                                                           const std::vector<T>& unknowns,
                                                                           Extent extent) {
  using namespace components_details;
  Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic> result;
  for (std::size_t j = 0; j < unknowns.size(); ++j) {
    std::vector<Dual<T>> variables = constants(unknowns);
    variables[j].partial[0] = T(1);
    const Components<T> column = partials<T>(components<Dual<T>>(problem, constants(parameters), variables, extent));
    if (j == 0) result.resize(column.size(), static_cast<Eigen::Index>(unknowns.size()));
    result.col(static_cast<Eigen::Index>(j)) = column;
  }
  return result;
}

}  // namespace verisq::stance
