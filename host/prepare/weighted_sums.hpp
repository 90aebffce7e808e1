/// The normal equations of a straight shape over many points at once: eight at a time, for the vectors of any
/// processor, with the same bits on all of them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "host/prepare/surface_distance.hpp"

namespace verisq::recovery {

inline constexpr std::size_t lanes = 8;

/// Eight points; `present` is 0 for those that only fill up the last block.
struct PointBlock {
  alignas(64) std::array<double, lanes> x;
  alignas(64) std::array<double, lanes> y;
  alignas(64) std::array<double, lanes> z;
  alignas(64) std::array<double, lanes> present;
};

[[nodiscard]] std::vector<PointBlock> blocks_of(std::span<const Eigen::Vector3d> points);

/// For each point, the number of points, itself included, that are nearer than the root of `squared_radius`.
[[nodiscard]] std::vector<std::int64_t> counts_within(std::span<const Eigen::Vector3d> points, double squared_radius);

/// An inlier's likelihood at the distance r is exp(-precision r^2), an outlier's is `ratio`.
struct MixtureTerms {
  double precision;
  double ratio;
};

inline constexpr std::size_t straight_parameters = 12;

/// -ln of the likelihood, summed, and the sums of w and w r^2.
struct MixtureSums {
  double cost = 0.0;
  double weights = 0.0;
  double squares = 0.0;
};

/// Over all points, w the probability to be an inlier, J the derivatives by the first twelve parameters of Step.
struct WeightedSums {
  MixtureSums mixture;
  std::array<double, straight_parameters> gradient{};                                 ///< of w r J
  std::array<std::array<double, straight_parameters>, straight_parameters> matrix{};  ///< of w J J^T, upper triangle
};

/// Also writes the distances r: eight a block. The taper varies only where `tapers`.
[[nodiscard]] WeightedSums weighted_sums(std::span<const PointBlock> blocks, const Shape& shape, bool tapers,
                                         const MixtureTerms& terms, std::span<double> distances);

/// The distances alone.
void distances_to(std::span<const PointBlock> blocks, const Shape& shape, std::span<double> distances);

/// Along the shape's axes, from the least to the greatest coordinate of the points whose distances are no larger than
/// `farthest`; -infinity if there are none.
[[nodiscard]] Eigen::Vector3d extent_of(std::span<const PointBlock> blocks, const Shape& shape,
                                        std::span<const double> distances, double farthest);

[[nodiscard]] MixtureSums mixture_sums(std::span<const PointBlock> blocks, const MixtureTerms& terms,
                                       std::span<const double> distances);

}  // namespace verisq::recovery
