/// One step of Levenberg and Marquardt's method for a shape, within what the parameters may be.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "host/recovery/shape.hpp"
#include "host/recovery/surface_distance.hpp"

namespace verisq::recovery {

/// The sums over all points that a step is made of: of w J J^T and w r J. N parameters vary, or are 0.
template <int N>
struct NormalEquations {
  Eigen::Matrix<double, N, N> matrix;
  Eigen::Matrix<double, N, 1> gradient;
};

/// No parameter goes farther at once than the linear equations can be right for; `size` is the cloud's.
[[nodiscard]] inline Step shortened(Step step, double size) {
  const double largest =
      std::max({step.segment<3>(0).norm() / (0.5 * size), step.segment<3>(3).norm() / 0.5,
                step.segment<3>(6).lpNorm<Eigen::Infinity>() / 0.7, step.segment<2>(9).lpNorm<Eigen::Infinity>() / 0.7,
                std::abs(step[11]) / 0.4, step.segment<2>(12).norm() * size / 0.4});
  if (largest > 1.0) step /= largest;
  return step;
}

/// Exponents that press against a limit stay there.
template <int N>
[[nodiscard]] Step damped_step(const NormalEquations<N>& equations, double damping, const Shape& shape, double size) {
  Step step = Step::Zero();
  std::array<bool, N> held{};
  for (int round = 0; round < 3; ++round) {
    Eigen::Matrix<double, N, N> matrix = equations.matrix;
    Eigen::Matrix<double, N, 1> right = -equations.gradient;
    const double floor = 1e-12 * std::max(matrix.diagonal().maxCoeff(), 1e-300);
    for (int i = 0; i < N; ++i) {
      matrix(i, i) += damping * matrix(i, i) + floor;
      if (!held[i]) continue;
      matrix.row(i).setZero();
      matrix.col(i).setZero();
      matrix(i, i) = 1.0;
      right[i] = 0.0;
    }
    step.setZero();
    step.template head<N>() = matrix.ldlt().solve(right);
    bool pressed = false;
    for (int i = 0; i < 2; ++i) {
      const bool beyond = (shape.exponents[i] <= smallest_exponent && step[9 + i] < 0.0) ||
                          (shape.exponents[i] >= largest_exponent && step[9 + i] > 0.0);
      pressed = pressed || (beyond && !held[9 + i]);
      held[9 + i] = held[9 + i] || beyond;
    }
    if (!pressed) break;
  }
  if (!step.allFinite()) return Step::Zero();
  return shortened(step, size);
}

inline constexpr double smallest_axis = 1e-3;  ///< of the cloud's size
inline constexpr double largest_axis = 3.0;    ///< of a shape that is seen in part
inline constexpr double largest_part = 1.1;    ///< of a part of what is seen as a whole

/// Semi-axes in proportion to the cloud's size, and a bend that keeps well away from its limits (Bend).
[[nodiscard]] inline Shape limited(Shape shape, double size, double largest = largest_axis) {
  shape.axes = shape.axes.cwiseMax(smallest_axis * size).cwiseMin(largest * size);
  const double reach = std::max(shape.axes[0], shape.axes[1]) * (1.0 + std::abs(shape.taper));
  const double most = std::min(0.5 / reach, 1.5 / shape.axes[2]);
  if (const double curvature = shape.curvature.norm(); curvature > most) shape.curvature *= most / curvature;
  return shape;
}

}  // namespace verisq::recovery
