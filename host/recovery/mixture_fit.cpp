/// The steps: weights from the mixture, normal equations, a damped step, and the mixture anew from what is left over.
#include "host/recovery/mixture_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "host/recovery/damped_step.hpp"
#include "host/recovery/weighted_sums.hpp"

namespace verisq::recovery {
namespace {

constexpr double least_outliers = 1e-3;
// Of the logarithm of a semi-axis over half the extent of the points along it, where it is above 1: a cut that leaves
// 60 % of a surface leaves at least as much of its extent, ln(1/0.6) = 0.5.
constexpr double reach_deviation = 0.3;
constexpr double first_damping = 1e-3;
constexpr double least_damping = 1e-9;
constexpr double most_damping = 1e6;

/// And what the next mixture is made of.
template <int N>
struct MixtureEquations : NormalEquations<N> {
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

  MixtureEquations<N> evaluate(const Shape& shape, std::vector<double>& residuals) const {
    if constexpr (N == most_parameters) return evaluate_bent(shape, residuals);
    const WeightedSums sums = weighted_sums(blocks_, shape, tapers(options_.family), terms(), residuals);
    MixtureEquations<N> result;
    result.sums = sums.mixture;
    for (int i = 0; i < N; ++i) {
      result.gradient[i] = sums.gradient[i];
      for (int j = i; j < N; ++j) result.matrix(i, j) = result.matrix(j, i) = sums.matrix[i][j];
    }
    return result;
  }

  MixtureEquations<N> evaluate_bent(const Shape& shape, std::vector<double>& residuals) const {
    const DistanceToShape distance(shape, options_.family);
    const MixtureTerms with = terms();
    MixtureEquations<N> result;
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
    reach_ = (0.5 * extent_of(blocks_, shape_, residuals_, farthest)).cwiseMax(smallest_axis * options_.size);
    if (!reach_.allFinite()) reach_.setConstant(std::numeric_limits<double>::infinity());
  }

  /// From sums over the residuals with the mixture so far.
  void update_mixture(const MixtureSums& sums) {
    const auto count = static_cast<double>(points_.size());
    mixture_.outliers = std::min(std::max(1.0 - sums.weights / count, least_outliers), options_.most_outliers);
    if (sums.weights > 0.0) mixture_.noise = std::max(options_.least_noise, std::sqrt(sums.squares / sums.weights));
  }

  /// False when there is nothing more to gain.
  bool improve() {
    while (damping_ < most_damping) {
      const Step step = next_step();
      const Shape trial = limited(moved(shape_, step), options_.size);
      const MixtureEquations<N> at = evaluate(trial, trial_residuals_);
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

  [[nodiscard]] Step next_step() const {
    NormalEquations<N> equations{equations_.matrix, equations_.gradient};
    const double certainty = mixture_.noise * mixture_.noise / (reach_deviation * reach_deviation);
    const Eigen::Vector3d too_far = excess(shape_);
    for (int i = 0; i < 3; ++i) {
      if (too_far[i] <= 0.0) continue;
      equations.matrix(6 + i, 6 + i) += certainty;
      equations.gradient[6 + i] += certainty * too_far[i];
    }
    return damped_step<N>(equations, damping_, shape_, options_.size);
  }

  std::span<const Eigen::Vector3d> points_;
  std::vector<PointBlock> blocks_;
  MixtureOptions options_;
  std::vector<double> residuals_;
  std::vector<double> trial_residuals_;
  Shape shape_;
  Eigen::Vector3d reach_ = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Mixture mixture_{};
  MixtureEquations<N> equations_{};
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
