/// What a model of human stance must be to stand on the ground, and which of its joints an equilibrium leaves open.
#pragma once

#include <cstddef>
#include <vector>
#include <verisq/stance_equilibrium.hpp>

namespace verisq::stance {

/// Of Gauss's rule on a cylinder's axis, which presses with half of its stiffness at each.
constexpr std::size_t points_of_cylinder = 2;

/// Throws Error(input): without cylinders, without a root that first is translated and then turned about x and z, with
/// a horizontal applied force, with a controller of the root.
void require_standing_model(const Model& model);

/// Whose positions are sought: the root's rotations about x and z, then, with proportional control, those of all other
/// bodies. Precondition: a standing model.
[[nodiscard]] std::vector<std::size_t> sought_joints(const Model& model, JointControl control);

/// Along y: an equilibrium leaves it open, too. Precondition: a standing model.
[[nodiscard]] std::size_t height_of_root(const Model& model);

/// Of all joints, as their controllers turn them; 0 where none acts.
[[nodiscard]] std::vector<double> stiffness_of_joints(const Model& model);

/// Of a body's joint among all.
[[nodiscard]] std::size_t joint_index(const Model& model, std::size_t body, std::size_t joint);

}  // namespace verisq::stance
