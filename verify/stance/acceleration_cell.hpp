/// All joint accelerations over one box of parameters, by the parametric linear system of the equations of motion.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>
#include <verisq/stance_analysis.hpp>

#include "verify/stance/box_division.hpp"
#include "verify/stance/linear_system.hpp"
#include "verify/stance/reduced_motion.hpp"

namespace verisq::stance {

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
