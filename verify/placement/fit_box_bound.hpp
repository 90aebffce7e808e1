/// No pose of a box that keeps the limit has a larger objective than this (docs/mathematics.md §24).
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "verify/placement/distance_field.hpp"
#include "verify/placement/point_clusters.hpp"
#include "verify/placement/pose_box.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/fitness.hpp"

namespace verisq::verify {

struct FitBoxResult {
  double upper;           ///< F of every pose of the box that keeps the limit at the points; -infinity: none does
  double estimate;        ///< F at the centre, about; no proof
  double deepest;         ///< of a point at the centre, about; no proof
  PoseParameters spread;  ///< what each parameter adds to the bound, about: the widest is to be divided

  /// No pose keeps the limit.
  [[nodiscard]] static FitBoxResult nothing() {
    return {.upper = -infinity, .estimate = 0.0, .deepest = 0.0, .spread = PoseParameters::Zero()};
  }
};

/// Evaluates boxes for one implant; any number of threads may ask.
class FitBoxBound {
 public:
  /// Keeps references. Coordinates of points, poses and implant add up to at most `size`.
  FitBoxBound(const PoseSpace& space, const DistanceField& field, std::span<const WeightedPoint> points,
              const Fitness& fitness, double penetration_limit, double size);

  [[nodiscard]] FitBoxResult operator()(const PoseBox& box) const;

 private:
  class Sum;

  const PoseSpace& space_;
  const DistanceField& field_;
  std::vector<PointCluster> clusters_;
  std::size_t points_;
  Fitness fitness_;
  double penetration_limit_;
  double rounding_;
  double weight_;  ///< of all points, rounded up
};

}  // namespace verisq::verify
