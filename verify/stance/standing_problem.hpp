/// A model that is to stand: which of its postures are sought, and with what control.
#pragma once

#include <array>
#include <cstdint>
#include <vector>
#include <verisq/stance_equilibrium.hpp>

namespace verisq::stance {

struct StandingProblem {
  const Model& model;
  JointControl control;
  std::vector<std::uint32_t> parameters;  ///< the uncertain set
  std::vector<double> positions = {};     ///< of all joints in the file
  std::vector<double> stiffness = {};     ///< of all joints, as controllers turn them; 0 where none acts
  std::vector<std::size_t> joints = {};   ///< whose positions are sought: two rotations of the root first
  /// Of the point, in the root's frame, whose height is sought, too: near the cylinders.
  std::array<double, 3> reference = {};
  std::vector<double> start = {};  ///< the file's posture: that height, then the joints
};

/// Throws Error(input) as `equilibrium`.
[[nodiscard]] StandingProblem standing_problem(const Model& model, JointControl control, UncertainSet uncertain);

}  // namespace verisq::stance
