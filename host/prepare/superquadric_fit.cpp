/// This file implements superquadric_fit.hpp.
#include "host/prepare/superquadric_fit.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "host/prepare/surface_samples.hpp"

namespace verisq::recovery {
namespace {

constexpr double least_outliers = 1e-3;
// Deviation of the logarithm of a semi-axis over half the extent of the points along it, where it is above 1. A cut
// that leaves 60 % of a surface leaves at least as much of its extent, ln(1/0.6) = 0.5.
constexpr double reach_deviation = 0.3;
constexpr double first_damping = 1e-3;
constexpr double least_damping = 1e-9;
constexpr double most_damping = 1e6;

/// With the sums for the next mixture.
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
  /// The ratio of an outlier's likelihood to that of a point on the surface.
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

  /// How far the shape goes beyond the points that belong to it, in logarithms, and the cost of that.
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

  /// Updates the mixture from sums over the residuals with the mixture so far.
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

namespace {

constexpr double most_pointed = 1.99;  // at 2 itself nothing is smooth
constexpr double inlier = 3.0;         // so many times the noise from the surface at most
constexpr double filled = 0.9;         // of an axis, by points: then there is no shorter shape

/// The diagonal of the section becomes an axis: at 45 degrees a superellipse of semi-axis a reaches a sqrt 2 2^(-e/2).
Shape turned(Shape shape) {
  shape.rotation =
      shape.rotation * Eigen::AngleAxisd(0.25 * std::numbers::pi, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const double diagonal = std::sqrt(2.0 * shape.axes[0] * shape.axes[1]) * std::exp2(-0.5 * shape.exponents[1]);
  shape.axes[0] = shape.axes[1] = diagonal;
  shape.exponents[1] = 2.0 - shape.exponents[1];
  return shape;
}

/// The axis of that index becomes z, and the exponents change places.
Shape relabelled(const Shape& shape, int z) {
  Shape result = shape;
  const int x = (z + 1) % 3;
  const int y = (z + 2) % 3;
  result.rotation << shape.rotation.col(x), shape.rotation.col(y), shape.rotation.col(z);
  result.axes = {shape.axes[x], shape.axes[y], shape.axes[z]};
  result.exponents = {shape.exponents[1], shape.exponents[0]};
  result.taper = 0.0;
  result.curvature.setZero();
  return result;
}

void add_shorter(const MixtureFit& fit, std::span<const Eigen::Vector3d> points, std::vector<Shape>& shapes) {
  const Shape& shape = fit.shape;
  const DistanceToShape distance(shape, Family::plain);
  Eigen::Vector3d lowest = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d highest = -lowest;
  for (const Eigen::Vector3d& point : points) {
    if (std::abs(distance.value(point)) > inlier * fit.mixture.noise) continue;
    const Eigen::Vector3d local = shape.rotation.transpose() * (point - shape.centre);
    lowest = lowest.cwiseMin(local);
    highest = highest.cwiseMax(local);
  }
  for (int i = 0; i < 3; ++i) {
    const double half = 0.5 * (highest[i] - lowest[i]);
    if (!(half > 0.0) || half > filled * shape.axes[i]) continue;
    Shape ended = shape;
    ended.axes[i] = half;
    ended.centre += shape.rotation.col(i) * (0.5 * (highest[i] + lowest[i]));
    Shape half_way = shape;
    half_way.axes[i] = 0.5 * (half + shape.axes[i]);
    half_way.centre = 0.5 * (ended.centre + shape.centre);
    shapes.push_back(ended);
    shapes.push_back(half_way);
  }
}

}  // namespace

std::vector<Shape> alternative_shapes(const MixtureFit& fit, std::span<const Eigen::Vector3d> points) {
  std::vector<Shape> shapes{turned(fit.shape)};
  for (int z = 0; z < 2; ++z) {
    shapes.push_back(relabelled(fit.shape, z));
    shapes.push_back(turned(shapes.back()));
    shapes.push_back(relabelled(shapes.front(), z));
  }
  for (Shape& shape : shapes) shape.exponents = shape.exponents.cwiseMax(smallest_exponent).cwiseMin(most_pointed);
  add_shorter(fit, points, shapes);
  return shapes;
}

namespace {

// Found by trial on the rows of bench/recovery_bench.cpp, in part on cases that it counts.
constexpr std::size_t most_compared = 1000;  // points, all pairs of them, for densities
constexpr std::size_t few = 150;             // points of a start
constexpr int start_iterations = 14;
constexpr double start_precision = 1e-3;
constexpr double start_noise = 0.1;         // of the cloud's size
constexpr double alternative_noise = 0.03;  // likewise
constexpr double start_outliers = 0.1;
constexpr double least_noise = 3e-3;        // of the cloud's size, before the last steps
constexpr int rounds = 3;                   // of alternatives
constexpr std::size_t kept = 4;             // polished on all points
constexpr int first_polish_iterations = 8;  // then what is hopeless is left out
constexpr int polish_iterations = 22;
constexpr int last_iterations = 30;
constexpr double hopeless = 30.0;  // in the logarithm of the likelihood
constexpr double polish_precision = 1e-4;
constexpr double last_precision = 1e-9;
// Share of the noise, over the size: parameters are not known better than to a multiple of it, so more steps are
// useless.
constexpr double precision_in_noise = 1e-3;
constexpr double gain = 0.1;            // in the logarithm of the likelihood, that is worth another round
constexpr double noise_step = 0.03;     // the least noise becomes so many times what it was
constexpr double no_noise = 1e-13;      // of the cloud's size
constexpr double outliers_lost = 0.05;  // more outliers than before: the noise was no longer noise

std::vector<Eigen::Vector3d> shuffled(std::span<const Eigen::Vector3d> points, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Eigen::Vector3d> result(points.begin(), points.end());
  for (std::size_t i = result.size(); i > 1; --i) std::swap(result[i - 1], result[random() % i]);
  return result;
}

/// Returns whether both are the same optimum, in the same parametrisation.
bool alike(const MixtureFit& a, const MixtureFit& b) {
  constexpr double near = 1e-2;
  return std::abs(a.cost - b.cost) < near * (1.0 + std::abs(a.cost)) &&
         (a.shape.centre - b.shape.centre).norm() < near * a.shape.axes.maxCoeff() &&
         std::abs(a.shape.axes.prod() / b.shape.axes.prod() - 1.0) < 2.0 * near &&
         (a.shape.rotation.transpose() * b.shape.rotation).cwiseAbs().colwise().maxCoeff().minCoeff() > 0.999 &&
         std::abs(a.shape.rotation.col(2).dot(b.shape.rotation.col(2))) > 1.0 - near;
}

class SingleSearch {
 public:
  SingleSearch(std::span<const Eigen::Vector3d> points, const SingleOptions& options)
      : points_(shuffled(points, options.seed)),
        dense_(dense_points(std::span(points_).first(std::min(most_compared, points_.size())))),
        part_(std::span(dense_).first(std::min(few, dense_.size()))),
        axes_(principal_axes(dense_)) {
    const Eigen::Vector3d half = box_along(dense_, axes_).half;
    size_ = half.maxCoeff();
    // A box's faces over the volume of a box of twice its lengths, which contains the outliers: only the order matters.
    options_ = {.family = options.family,
                .size = size_,
                .area_over_volume = half.cwiseInverse().sum() / 2.0,
                .least_noise = least_noise * size_,
                .iterations = start_iterations,
                .precision = start_precision};
    if (options.most_outliers) options_.most_outliers = *options.most_outliers;
  }

  MixtureFit run() {
    add_starts();
    for (int round = 0; round < rounds; ++round)
      if (!add_alternatives()) break;
    return sharpened(polished());
  }

 private:
  void add(const MixtureFit& fit) {
    const auto same = std::ranges::find_if(found_, [&fit](const MixtureFit& other) { return alike(fit, other); });
    if (same == found_.end())
      found_.push_back(fit);
    else if (fit.cost < same->cost)
      *same = fit;
  }

  void sort() {
    std::ranges::stable_sort(found_, [](const MixtureFit& a, const MixtureFit& b) { return a.cost < b.cost; });
  }

  /// Each principal axis as z, the other two as they are and turned by 45 degrees.
  void add_starts() {
    for (int z = 0; z < 3; ++z) {
      for (const double angle : {0.0, 0.25 * std::numbers::pi}) {
        Shape start;
        start.rotation << axes_.col((z + 1) % 3), axes_.col((z + 2) % 3), axes_.col(z);
        start.rotation *= Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
        const OrientedBox box = box_along(dense_, start.rotation);
        start.centre = box.centre;
        start.axes = box.half;
        add(fit_mixture(part_, start, {start_noise * size_, std::min(start_outliers, options_.most_outliers)},
                        options_));
      }
    }
    sort();
  }

  [[nodiscard]] Mixture loosened(const Mixture& mixture) const {
    return {std::max(mixture.noise, alternative_noise * size_), mixture.outliers};
  }

  /// Returns whether one was better.
  bool add_alternatives() {
    const MixtureFit best = found_.front();
    for (const Shape& shape : alternative_shapes(best, part_))
      add(fit_mixture(part_, shape, loosened(best.mixture), options_));
    sort();
    return found_.front().cost < best.cost - gain;
  }

  /// The best fit, polished on all points.
  MixtureFit polished() {
    options_.precision = polish_precision;
    if (found_.size() > kept) found_.resize(kept);
    polish(first_polish_iterations);
    std::erase_if(found_, [best = found_.front().cost](const MixtureFit& fit) { return fit.cost > best + hopeless; });
    if (found_.size() > 1) polish(polish_iterations);  // one alone is finished by what follows
    return found_.front();
  }

  void polish(int iterations) {
    options_.iterations = iterations;
    for (MixtureFit& fit : found_) fit = fit_mixture(points_, fit.shape, fit.mixture, options_);
    sort();
  }

  [[nodiscard]] double precision_for(const Mixture& mixture) const {
    return std::max(last_precision, precision_in_noise * mixture.noise / size_);
  }

  /// While the noise is at its lower limit, the limit is lowered.
  MixtureFit sharpened(MixtureFit best) {
    options_.iterations = last_iterations;
    options_.precision = precision_for(best.mixture);
    best = fit_mixture(points_, best.shape, best.mixture, options_);
    while (best.mixture.noise <= 1.01 * options_.least_noise && options_.least_noise > no_noise * size_) {
      options_.least_noise *= noise_step;
      options_.precision = precision_for({options_.least_noise, best.mixture.outliers});
      const MixtureFit fit = fit_mixture(points_, best.shape, best.mixture, options_);
      if (fit.mixture.outliers > best.mixture.outliers + outliers_lost) break;
      best = fit;
    }
    return best;
  }

  std::vector<Eigen::Vector3d> points_;
  std::vector<Eigen::Vector3d> dense_;
  std::span<const Eigen::Vector3d> part_;
  Eigen::Matrix3d axes_;
  double size_ = 0.0;
  MixtureOptions options_{};
  std::vector<MixtureFit> found_;
};

}  // namespace

MixtureFit recover_single(std::span<const Eigen::Vector3d> points, const SingleOptions& options) {
  return SingleSearch(points, options).run();
}

}  // namespace verisq::recovery
