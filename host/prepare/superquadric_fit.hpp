/// One superquadric for a cloud, some of whose points may belong to nothing.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "host/prepare/surface_distance.hpp"

namespace verisq::recovery {

// One step of Levenberg and Marquardt's method for a shape, within the allowed range of the parameters.

/// The sums over all points that determine a step: of w J J^T and w r J. N parameters vary, or are 0.
template <int N>
struct NormalEquations {
  Eigen::Matrix<double, N, N> matrix;
  Eigen::Matrix<double, N, 1> gradient;
};

/// Limits each parameter to the range in which the linear equations can be right; `size` is the cloud's.
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

inline constexpr double smallest_axis = 1e-3;  ///< share of the cloud's size
inline constexpr double largest_axis = 3.0;    ///< for a shape that is seen in part
inline constexpr double largest_part = 1.1;    ///< for a part of a shape that is seen as a whole

/// Semi-axes in proportion to the cloud's size, and a bend that keeps well away from its limits (Bend).
[[nodiscard]] inline Shape limited(Shape shape, double size, double largest = largest_axis) {
  shape.axes = shape.axes.cwiseMax(smallest_axis * size).cwiseMin(largest * size);
  const double reach = std::max(shape.axes[0], shape.axes[1]) * (1.0 + std::abs(shape.taper));
  const double most = std::min(0.5 / reach, 1.5 / shape.axes[2]);
  if (const double curvature = shape.curvature.norm(); curvature > most) shape.curvature *= most / curvature;
  return shape;
}

// Fits one shape to points, some of which may be outliers. It climbs the likelihood of a mixture of the shape's surface
// with noise and of outliers, by expectation maximisation and Levenberg and Marquardt's method.

/// A point belongs to the surface with the probability 1 - outliers, and then lies `noise` from it, normally
/// distributed; else anywhere in the cloud's box.
struct Mixture {
  double noise;
  double outliers;
};

struct MixtureOptions {
  Family family = Family::plain;
  double size;              ///< size of the cloud, a length: steps and semi-axes are limited in proportion to it
  double area_over_volume;  ///< about the surface's area over the box's volume, 1/length
  double least_noise;       ///< the noise is never taken for less
  double most_outliers = 0.6;
  bool prior = true;  ///< semi-axes far beyond the points are unlikely
  int iterations = 30;
  double precision = 1e-6;  ///< ends when no parameter moves by more, in proportion
};

struct MixtureFit {
  Shape shape;
  Mixture mixture;
  double cost;  ///< -log of the likelihood of all points, up to a constant of the cloud
};

/// Climbs from `start`. Deterministic. Precondition: at least one point.
[[nodiscard]] MixtureFit fit_mixture(std::span<const Eigen::Vector3d> points, const Shape& start,
                                     const Mixture& mixture, const MixtureOptions& options);

/// The cost of a shape whose mixture is fitted and whose parameters stay.
[[nodiscard]] MixtureFit assess(std::span<const Eigen::Vector3d> points, const Shape& shape, const Mixture& mixture,
                                const MixtureOptions& options);

// Shapes that look much like a given one but are far from it in the search's parameters: another optimum may be near
// them ("switching" of Liu et al., CVPR 2022).

/// Another axis as z, and the section turned by 45 degrees with its exponent on the other side of 1: a square is a
/// rhombus too. If the points of the fit end well before the shape does, also shapes that end with them, or half way.
[[nodiscard]] std::vector<Shape> alternative_shapes(const MixtureFit& fit, std::span<const Eigen::Vector3d> points);

// One shape for a cloud: from many starts on a part of its points, the best of them on all.

struct SingleOptions {
  Family family = Family::plain;
  std::uint64_t seed = 1;
  std::optional<double> most_outliers;  ///< share of the points; nothing: 0.6
};

/// The same seed gives the same bits. Precondition: at least four points, not all in a plane.
[[nodiscard]] MixtureFit recover_single(std::span<const Eigen::Vector3d> points, const SingleOptions& options);

}  // namespace verisq::recovery
