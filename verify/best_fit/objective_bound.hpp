/// No pose of a box that keeps the limit has a larger objective than this (docs/mathematics.md §24), in intervals.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "verify/best_fit/box_of_poses.hpp"
#include "verify/best_fit/pose_cell.hpp"
#include "verify/best_fit/solid_field.hpp"
#include "verify/best_fit/weighted_balls.hpp"
#include "verisq/fitness.hpp"
#include "verisq/model.hpp"
#include "verisq/pose_range.hpp"

namespace verisq::verify {

/// What is bounded: Σ weight f(distance of a point), where no point lies deeper than the limit.
struct BoundedObjective {
  Fitness fitness;
  double penetration_limit;
  std::vector<WeightedBall> balls;  ///< of all points
};

struct BoxBound {
  double upper;  ///< proven of every pose of the box that keeps the limit; -infinity: none does
  std::array<double, pose_parameters> spread;  ///< what each direction adds to it, about: the widest is to be divided
};

/// Of one implant. Any number of threads may ask.
class ObjectiveBound {
 public:
  /// Keeps a reference of the objective. Precondition: a union of convex primitives; all numbers finite.
  ObjectiveBound(const Model& implant, const Point& centre, const PoseRange& range, const BoundedObjective& objective);

  [[nodiscard]] BoxBound operator()(const PoseCell& cell) const;

 private:
  class Sum;

  RangeOfPoses range_;
  SolidField field_;
  const BoundedObjective& objective_;
};

}  // namespace verisq::verify
