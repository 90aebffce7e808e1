/// Ellipsoids along the principal axes as starts, alternatives of what they become, and the best few on all points.
#include "host/recovery/single_recovery.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "host/recovery/alternative_shapes.hpp"
#include "host/recovery/cloud_frame.hpp"

namespace verisq::recovery {
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
// Of the noise, over the size: parameters are not known better than to a multiple of it, so more steps say nothing.
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

/// Whether both are the same optimum, in the same parametrisation.
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
    // A box's faces over the volume of one of twice its lengths, where outliers lie: only the order matters.
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

  /// Whether one was better.
  bool add_alternatives() {
    const MixtureFit best = found_.front();
    for (const Shape& shape : alternative_shapes(best, part_))
      add(fit_mixture(part_, shape, loosened(best.mixture), options_));
    sort();
    return found_.front().cost < best.cost - gain;
  }

  /// On all points.
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

  /// As long as the noise is as small as it may be, it may be smaller.
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
