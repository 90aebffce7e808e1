/// Fits one shape to points, some of which may belong to nothing: the likelihood of a mixture of the shape's surface
/// with noise and of outliers, climbed by expectation maximisation and Levenberg and Marquardt's method.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "host/recovery/shape.hpp"
#include "host/recovery/surface_distance.hpp"

namespace verisq::recovery {

/// A point belongs to the surface with the probability 1 - outliers, and then lies `noise` from it, normally
/// distributed; else anywhere in the cloud's box.
struct Mixture {
  double noise;
  double outliers;
};

struct MixtureOptions {
  Family family = Family::plain;
  double size;              ///< of the cloud, a length: steps and semi-axes are limited in proportion to it
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

}  // namespace verisq::recovery
