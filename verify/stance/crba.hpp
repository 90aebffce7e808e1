/// The mass matrix by the composite-rigid-body algorithm, over any scalar (Featherstone, Rigid Body Dynamics
/// Algorithms, table 6.2).
#pragma once

#include <Eigen/Dense>
#include <span>

#include "verify/stance/tree.hpp"

namespace verisq::stance {

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
