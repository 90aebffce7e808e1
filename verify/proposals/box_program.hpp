/// Small linear programs over boxes: what linear constraints leave of the largest value of a linear function.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace verisq::verify {

using PoseParameters = Eigen::Matrix<double, 6, 1>;  ///< a translation, then a rotation vector

/// constant + slope·δ >= 0
struct LinearConstraint {
  double constant;
  PoseParameters slope;
  double tightness = 0.0;  ///< constant by the range of slope·δ: the smaller, the more of the box is excluded
};

/// Multipliers λ >= 0, one a constraint, which make
///     Σ λ c + Σ_k half_k |objective_k + Σ λ a_k|
/// small: by weak duality no δ of the box |δ| <= half that keeps the constraints has more objective·δ than that,
/// whatever λ is. Where `ray` is true the same with objective 0 is negative: there is no such δ. Found by the simplex
/// method in floating point: whoever uses them evaluates them.
struct Multipliers {
  std::vector<double> values;
  bool ray = false;
};

[[nodiscard]] Multipliers multipliers(const PoseParameters& objective, const PoseParameters& half,
                                      std::span<const LinearConstraint> constraints);

}  // namespace verisq::verify
