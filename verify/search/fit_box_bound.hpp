/// Bounds of a fit's objective on boxes of poses.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "verify/numbers/vector.hpp"
#include "verify/search/distance_field.hpp"
#include "verisq/clearance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/map.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// A straight line above the fitness over a range of distances.

/// f(max(d, target)): no smaller than f, and does not rise with d. Accurate to a few 2^-53.
[[nodiscard]] inline double falling_fitness(const Fitness& fitness, double distance) {
  const double u = std::max(distance - fitness.target, 0.0) / fitness.scale;
  return 1.0 / (1.0 + u * u);
}

/// The largest of |f'|: at 1/√3 of the scale beyond the target, 3√3/8 a scale; rounded up.
[[nodiscard]] inline double steepest_fitness_in_binary64(const Fitness& fitness) {
  return 0.6495190528383291 / fitness.scale;
}

/// f(max(d, target)) <= value + slope (d - middle) for every d within `half` of the middle, but for a few 2^-53.
struct FitnessLine {
  double value;
  double slope;  ///< <= 0
};

// With u = (d - target)/scale, g(u) = 1/(1 + max(u, 0)²) is concave up to 1/√3 and convex beyond. Its concave envelope
// over [l, v] is g up to t, where the tangent runs through (v, g(v)), and that straight line from there. The tangency
// is (t - v)²(t² + 2vt - 1) = 0. Its root below v is t = 1/(v + √(1 + v²)) if v > 1/√3; otherwise t >= v and g is
// concave all along. If l lies beyond t, the chord of l and v is the envelope. Any line that supports the envelope at a
// point lies above g: here at the middle.
[[nodiscard]] inline FitnessLine fitness_line_above(const Fitness& fitness, double middle, double half) {
  const double m = (middle - fitness.target) / fitness.scale;
  const double h = half / fitness.scale;
  const double v = m + h;
  if (v <= 0.0) return {1.0, 0.0};
  const double t = 1.0 / (v + std::sqrt(1.0 + v * v));
  if (m <= t || v <= t) {
    const double at = std::max(m, 0.0);
    const double g = 1.0 / (1.0 + at * at);
    return {g, -2.0 * at * g * g / fitness.scale};
  }
  const double p = std::max(m - h, t);
  const double of_p = 1.0 / (1.0 + p * p);
  const double slope = -(v + p) * of_p / (1.0 + v * v);
  return {of_p + slope * (m - p), slope / fitness.scale};
}

// Weighted points in a tree of balls: bounds of sums over many points ask few of the balls.

/// A point of the cavity and its weight.
struct WeightedPoint {
  Eigen::Vector3d place;
  double weight;  ///< >= 0
};

/// All points of a ball about their centre of mass: the sum of weight times (place - centre) is 0, but for roundings.
/// A leaf is one point, at the centre, of radius 0.
struct PointCluster {
  Eigen::Vector3d centre;
  double radius;         ///< rounded up
  double weight;         ///< sum of the weights, to nearest
  std::uint32_t second;  ///< index of the second child; the first follows its parent; 0: a leaf
};

/// The root is the first. Precondition: at least one point.
[[nodiscard]] std::vector<PointCluster> point_clusters(std::span<const WeightedPoint> points);

// Bounds the objective over all poses of a box that keep the limit (docs/mathematics.md §24).

struct FitBoxResult {
  double upper;  ///< bound of F for every pose of the box that keeps the limit at the points; -infinity: no pose does
  double estimate;        ///< F at the centre, about; no proof
  double deepest;         ///< of a point at the centre, about; no proof
  PoseParameters spread;  ///< about each parameter's contribution to the bound: the parameter with the widest is to be
                          ///< divided

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
