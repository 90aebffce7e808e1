/// Weighted points in a tree of balls: bounds of sums over many points ask few of the balls.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "verisq/model.hpp"

namespace verisq::verify {

/// A point and its weight, which is not negative.
struct PointOfWeight {
  Point place;
  double weight;
};

/// All points of a ball; all but the centre rounded up.
struct WeightedBall {
  Point centre;
  double radius;
  double weight;         ///< of all
  double moment;         ///< |Σ weight (point - centre)|
  std::uint32_t second;  ///< index of the second child; the first follows its parent; 0: a single point, the centre
};

/// The root is the first. Precondition: at least one point, finite.
[[nodiscard]] std::vector<WeightedBall> weighted_balls(std::span<const PointOfWeight> points);

}  // namespace verisq::verify
