/// Equilibria over one box of parameters, by Krawczyk's operator (docs/stance.md §7).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>
#include <verisq/stance_equilibrium.hpp>

#include "verify/stance/contraction.hpp"
#include "verify/stance/mean_value_range.hpp"

namespace verisq::stance {

/// A model that is to stand.
struct StandingProblem {
  const Model& model;
  JointControl control;
  std::vector<std::uint32_t> parameters;  ///< the uncertain set
  std::vector<std::size_t> joints = {};   ///< whose positions are sought: two rotations of the root first
  std::array<double, 3> origin = {};      ///< of the root, by its translations in the file
  /// Of the point, in the root's frame, whose height is sought, too: near the cylinders.
  std::array<double, 3> reference = {};
  std::vector<double> start = {};  ///< the file's posture: that height, then the joints
};

/// Throws Error(input) as `equilibrium`.
[[nodiscard]] StandingProblem standing_problem(const Model& model, JointControl control, UncertainSet uncertain);

/// What an equilibrium consists of, over a box of parameters: a part of its components, by name.
struct StandingRanges {
  std::vector<verify::Interval> unknowns;      ///< as StandingProblem::start
  std::vector<verify::Interval> penetrations;  ///< of all points
  std::vector<verify::Interval> forces;        ///< of all cylinders
  verify::Interval pressure_x, pressure_z;     ///< the centre of pressure
  verify::Interval root_translation;           ///< along y
  std::vector<verify::Interval> torques;       ///< of all joints, 0 of the root's
};
[[nodiscard]] StandingRanges named(const StandingProblem& problem, const IntervalVector& components);

struct CellVerdict {
  StandingVerdict verdict = StandingVerdict::open;
  IntervalVector components = {};  ///< ranges of what an equilibrium consists of, where it stands
  /// Then, by uncertain parameter: how much of each range's width is there because the sign of its derivative is open.
  std::vector<Eigen::VectorXd> unclear = {};
};

/// `parameters` has an interval for each parameter of the model.
[[nodiscard]] CellVerdict examine(const StandingProblem& problem, const Box& parameters);

/// The components at one sample, in plain floating point; nothing where it does not stand on all cylinders.
[[nodiscard]] std::optional<Eigen::VectorXd> sampled_equilibrium(const StandingProblem& problem,
                                                                 const std::vector<double>& parameters);

}  // namespace verisq::stance
