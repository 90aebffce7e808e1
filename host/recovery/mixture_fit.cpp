/// The steps: weights from the mixture, normal equations, a damped step, and the mixture anew from what is left over.
#include "host/recovery/mixture_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "host/recovery/weighted_sums.hpp"

namespace verisq::recovery {
namespace {

constexpr double least_outliers = 1e-3;
constexpr double smallest_axis = 1e-3;  // of the cloud's size
constexpr double largest_axis = 3.0;
// Of the logarithm of a semi-axis over half the extent of the points along it, where it is above 1: a cut that leaves
// 60 % of a surface leaves at least as much of its extent, ln(1/0.6) = 0.5.
constexpr double reach_deviation = 0.3;
constexpr double first_damping = 1e-3;
constexpr double least_damping = 1e-9;
constexpr double most_damping = 1e6;

/// The sums over all points that a step and the next mixture are made of. N parameters vary, or are 0.
template <int N>
struct NormalEquations {
  Eigen::Matrix<double, N, N> matrix;  ///< upper triangle
  Eigen::Matrix<double, N, 1> gradient;
  MixtureSums sums;
};

template <int N>
class MixtureSearch {
 public:
  MixtureSearch(std::span<const Eigen::Vector3d> points, const MixtureOptions& options)
      : points_(points),
        blocks_(blocks_of(points)),
        options_(options),
        residuals_(blocks_.size() * lanes),
        trial_residuals_(residuals_.size()) {}

  MixtureFit run(const Shape& start, const Mixture& mixture) {
    shape_ = start;
    mixture_ = mixture;
    equations_ = evaluate(shape_, residuals_);
    update_reach();
    for (int i = 0; i < options_.iterations; ++i)
      if (!improve()) break;
    return {shape_, mixture_, cost_with_constants()};
  }

  MixtureFit assess(const Shape& shape, const Mixture& mixture) {
    shape_ = shape;
    mixture_ = mixture;
    const DistanceToShape distance(shape, options_.family);
    for (std::size_t i = 0; i < points_.size(); ++i) residuals_[i] = distance.value(points_[i]);
    for (int i = 0; i < 20; ++i) update_mixture(mixture_sums(blocks_, terms(), residuals_));
    return {shape_, mixture_, cost_with_constants()};
  }

 private:
  /// Of an outlier's likelihood to that of a point on the surface.
  [[nodiscard]] double outlier_ratio() const {
    return mixture_.outliers / (1.0 - mixture_.outliers) * mixture_.noise * std::sqrt(2.0 * std::numbers::pi) *
           options_.area_over_volume;
  }

  [[nodiscard]] MixtureTerms terms() const { return {0.5 / (mixture_.noise * mixture_.noise), outlier_ratio()}; }

  NormalEquations<N> evaluate(const Shape& shape, std::vector<double>& residuals) const {
    if constexpr (N == most_parameters) return evaluate_bent(shape, residuals);
    const WeightedSums sums = weighted_sums(blocks_, shape, tapers(options_.family), terms(), residuals);
    NormalEquations<N> result;
    result.sums = sums.mixture;
    for (int i = 0; i < N; ++i) {
      result.gradient[i] = sums.gradient[i];
      for (int j = i; j < N; ++j) result.matrix(i, j) = result.matrix(j, i) = sums.matrix[i][j];
    }
    return result;
  }

  NormalEquations<N> evaluate_bent(const Shape& shape, std::vector<double>& residuals) const {
    const DistanceToShape distance(shape, options_.family);
    const MixtureTerms with = terms();
    NormalEquations<N> result;
    result.matrix.setZero();
    result.gradient.setZero();
    SurfaceDistance at;
    for (std::size_t k = 0; k < points_.size(); ++k) {
      distance.evaluate(points_[k], at);
      residuals[k] = at.value;
      const double likelihood = std::exp(-with.precision * at.value * at.value);
      const Eigen::Matrix<double, N, 1> row = at.derivatives.template head<N>();
      const Eigen::Matrix<double, N, 1> weighted = likelihood / (likelihood + with.ratio) * row;
      result.gradient += at.value * weighted;
      result.matrix.noalias() += weighted * row.transpose();
    }
    result.sums = mixture_sums(blocks_, with, residuals);
    return result;
  }

  [[nodiscard]] double cost_of_residuals() const { return mixture_sums(blocks_, terms(), residuals_).cost; }

  /// Comparable between mixtures.
  [[nodiscard]] double cost_with_constants() const {
    const auto count = static_cast<double>(points_.size());
    return cost_of_residuals() + prior_cost(shape_) +
           count * std::log(mixture_.noise / (options_.size * (1.0 - mixture_.outliers)));
  }

  /// How far beyond the points that belong to it the shape goes, in logarithms, and what that costs.
  [[nodiscard]] Eigen::Vector3d excess(const Shape& shape) const {
    return shape.axes.cwiseQuotient(reach_).array().log().max(0.0);
  }
  [[nodiscard]] double prior_cost(const Shape& shape) const {
    return 0.5 * excess(shape).squaredNorm() / (reach_deviation * reach_deviation);
  }

  /// Half the extent of the inliers along the shape's axes.
  void update_reach() {
    if (!options_.prior) return;
    const double farthest = mixture_.noise * std::sqrt(2.0 * std::log(1.0 / std::min(outlier_ratio(), 0.5)));
    Eigen::Vector3d lowest = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
    Eigen::Vector3d highest = -lowest;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (std::abs(residuals_[i]) > farthest) continue;
      const Eigen::Vector3d local = shape_.rotation.transpose() * points_[i];
      lowest = lowest.cwiseMin(local);
      highest = highest.cwiseMax(local);
    }
    reach_ = (0.5 * (highest - lowest)).cwiseMax(smallest_axis * options_.size);
    if (!reach_.allFinite()) reach_.setConstant(std::numeric_limits<double>::infinity());
  }

  /// From sums over the residuals with the mixture so far.
  void update_mixture(const MixtureSums& sums) {
    const auto count = static_cast<double>(points_.size());
    mixture_.outliers = std::clamp(1.0 - sums.weights / count, least_outliers, options_.most_outliers);
    if (sums.weights > 0.0) mixture_.noise = std::max(options_.least_noise, std::sqrt(sums.squares / sums.weights));
  }

  /// False when there is nothing more to gain.
  bool improve() {
    while (damping_ < most_damping) {
      const Step step = damped_step();
      const Shape trial = limited(moved(shape_, step));
      const NormalEquations<N> at = evaluate(trial, trial_residuals_);
      if (at.sums.cost + prior_cost(trial) < equations_.sums.cost + prior_cost(shape_)) {
        const bool settled = step.template lpNorm<Eigen::Infinity>() < options_.precision;
        shape_ = trial;
        std::swap(residuals_, trial_residuals_);
        equations_ = at;
        damping_ = std::max(least_damping, damping_ / 6.0);
        const double noise = mixture_.noise;
        update_mixture(at.sums);
        update_reach();
        equations_.sums = mixture_sums(blocks_, terms(), residuals_);
        return !settled || std::abs(mixture_.noise - noise) > 1e-3 * noise;
      }
      if (step.template lpNorm<Eigen::Infinity>() < options_.precision) break;
      damping_ *= 8.0;
    }
    const double noise = mixture_.noise;
    update_mixture(equations_.sums);
    damping_ = first_damping;
    if (std::abs(mixture_.noise - noise) < 1e-3 * noise) return false;
    equations_ = evaluate(shape_, residuals_);
    return true;
  }

  /// Centre and curvature in proportion to the size. Exponents and the taper that press against a limit stay.
  Step damped_step() const {
    Step step = Step::Zero();
    std::array<bool, N> held{};
    for (int round = 0; round < 4; ++round) {
      Eigen::Matrix<double, N, N> matrix = equations_.matrix;
      Eigen::Matrix<double, N, 1> right = -equations_.gradient;
      const double certainty = mixture_.noise * mixture_.noise / (reach_deviation * reach_deviation);
      const Eigen::Vector3d too_far = excess(shape_);
      for (int i = 0; i < 3; ++i) {
        if (too_far[i] <= 0.0) continue;
        matrix(6 + i, 6 + i) += certainty;
        right[6 + i] -= certainty * too_far[i];
      }
      const double floor = 1e-12 * std::max(matrix.diagonal().maxCoeff(), 1e-300);
      for (int i = 0; i < N; ++i) {
        matrix(i, i) += damping_ * matrix(i, i) + floor;
        if (!held[i]) continue;
        matrix.row(i).setZero();
        matrix.col(i).setZero();
        matrix(i, i) = 1.0;
        right[i] = 0.0;
      }
      const Eigen::Matrix<double, N, 1> solution = matrix.ldlt().solve(right);
      step.setZero();
      step.template head<N>() = solution;
      bool pressed = false;
      for (int i = 9; i < 11; ++i) {
        const double exponent = shape_.exponents[i - 9];
        const bool beyond =
            (exponent <= smallest_exponent && step[i] < 0.0) || (exponent >= largest_exponent && step[i] > 0.0);
        if (!held[i] && beyond) held[i] = pressed = true;
      }
      if (!pressed) break;
    }
    return shortened(step);
  }

  /// No parameter goes farther at once than the linear equations can be right for.
  [[nodiscard]] Step shortened(Step step) const {
    const double largest = std::max({step.segment<3>(0).norm() / (0.5 * options_.size), step.segment<3>(3).norm() / 0.5,
                                     step.segment<3>(6).template lpNorm<Eigen::Infinity>() / 0.7,
                                     step.segment<2>(9).template lpNorm<Eigen::Infinity>() / 0.7,
                                     std::abs(step[11]) / 0.4, step.segment<2>(12).norm() * options_.size / 0.4});
    if (largest > 1.0) step /= largest;
    return step;
  }

  [[nodiscard]] Shape limited(Shape shape) const {
    shape.axes = shape.axes.cwiseMax(smallest_axis * options_.size).cwiseMin(largest_axis * options_.size);
    const double reach = std::max(shape.axes[0], shape.axes[1]) * (1.0 + std::abs(shape.taper));
    const double most = std::min(0.7 / reach, 2.0 / shape.axes[2]);
    if (const double curvature = shape.curvature.norm(); curvature > most) shape.curvature *= most / curvature;
    return shape;
  }

  std::span<const Eigen::Vector3d> points_;
  std::vector<PointBlock> blocks_;
  MixtureOptions options_;
  std::vector<double> residuals_;
  std::vector<double> trial_residuals_;
  Shape shape_;
  Eigen::Vector3d reach_ = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Mixture mixture_{};
  NormalEquations<N> equations_{};
  double damping_ = first_damping;
};

}  // namespace

MixtureFit fit_mixture(std::span<const Eigen::Vector3d> points, const Shape& start, const Mixture& mixture,
                       const MixtureOptions& options) {
  if (bends(options.family)) return MixtureSearch<14>(points, options).run(start, mixture);
  if (tapers(options.family)) return MixtureSearch<12>(points, options).run(start, mixture);
  return MixtureSearch<11>(points, options).run(start, mixture);
}

MixtureFit assess(std::span<const Eigen::Vector3d> points, const Shape& shape, const Mixture& mixture,
                  const MixtureOptions& options) {
  return MixtureSearch<11>(points, options).assess(shape, mixture);
}

}  // namespace verisq::recovery
