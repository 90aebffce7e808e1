/// Upper bounds of a fit's objective on a box of poses.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "verify/numbers/interval.hpp"
#include "verify/proof/solid_field.hpp"
#include "verisq/clearance.hpp"
#include "verisq/fit.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// A straight line above the fitness over a range of distances, proven by the sign of a polynomial.

/// f(max(d, target)) >= f(d) for all distances from `distance` on: it never rises. Rounded up.
[[nodiscard]] inline double falling_fitness_up(const Fitness& fitness, double distance) {
  if (!(distance > fitness.target)) return 1.0;
  if (distance == infinity) return 0.0;
  const Interval u = (Interval(distance) - Interval(fitness.target)) / Interval(fitness.scale);
  return std::min((Interval(1) / (Interval(1) + square(u))).upper(), 1.0);
}

/// The largest of |f'| beyond the target: 3√3/8 a scale, where (d - target)/scale is 1/√3.
[[nodiscard]] inline Interval steepest_fitness(const Fitness& fitness) {
  return Interval(3) * sqrt(Interval(3)) / (Interval(8) * Interval(fitness.scale));
}

/// f(max(d, target)) <= value + slope (d - middle) for every d of the range; slope <= 0.
struct LineAbove {
  Interval value;
  Interval slope;
};

// With u = (d - target)/scale, f(max(d, target)) is g(u) = 1/(1 + max(u, 0)²). Let 0 <= p <= v.
// The tangent T of 1/(1 + u²) at p is no smaller than g for all u <= v where p² + 2pv <= 1: for 0 <= u,
//     T(u) - g(u) = (u - p)² (1 - p² - 2pu) / ((1 + p²)² (1 + u²)),
// and for u < 0 it is no smaller than at 0, which is (1 + 3p²)/(1 + p²)² >= 1 because p² <= 1.
// The chord C from p to v is no smaller than g between them where p² + 2pv >= 1:
//     C(u) - g(u) = (u - p)(v - u)(uv + p(u + v) - 1) / ((1 + p²)(1 + u²)(1 + v²)).
// The best line touches the concave envelope of g at the middle, or is its straight part, from 1/(v + √(1 + v²)) to v.
[[nodiscard]] inline LineAbove line_above(const Fitness& fitness, double middle, double half) {
  const Interval target(fitness.target);
  const Interval scale(fitness.scale);
  const Interval u = (Interval(middle) - target) / scale;
  const double v = ((Interval(middle) + Interval(half) - target) / scale).upper();
  if (!(v > 0.0)) return {Interval(1), Interval(0)};
  const double lowest = ((Interval(middle) - Interval(half) - target) / scale).lower();
  const double tangency = 1.0 / (v + std::sqrt(1.0 + v * v));
  const auto unit = [](const Interval& x) { return Interval(1) / (Interval(1) + square(x)); };
  const auto line = [&](double p, const Interval& slope) {
    return LineAbove{unit(Interval(p)) + slope * (u - Interval(p)), slope / scale};
  };
  const auto sign = [v](double p) { return square(Interval(p)) + Interval(2) * Interval(p) * Interval(v); };
  if (lowest < tangency * (1.0 + 0x1p-30)) {
    const double p = std::clamp(u.lower(), 0.0, tangency * (1.0 - 0x1p-40));
    const Interval at = unit(Interval(p));
    if (p <= v && sign(p).upper() <= 1.0) return line(p, -(Interval(2) * Interval(p) * square(at)));
  } else if (sign(lowest).lower() >= 1.0) {
    const Interval sum = Interval(v) + Interval(lowest);
    return line(lowest, -(sum * unit(Interval(lowest)) * unit(Interval(v))));
  }
  return {Interval(falling_fitness_up(fitness, (Interval(middle) - Interval(half)).lower())), Interval(0)};
}

// Trees of balls of weighted points, halved along the longest direction: how they are made, and walked.

// A Ball has the index of its second child, `second`; the first follows its parent; 0: a single point. A WeightedPoint
// has a `place` of three coordinates.

template <class WeightedPoint>
[[nodiscard]] int longest_direction(std::span<const WeightedPoint> points) {
  std::array<double, 3> lengths{};
  for (int i = 0; i < 3; ++i) {
    const auto along = [i](const WeightedPoint& point) { return point.place[i]; };
    const auto [least, largest] = std::ranges::minmax_element(points, {}, along);
    lengths[static_cast<std::size_t>(i)] = along(*largest) - along(*least);
  }
  return static_cast<int>(std::ranges::max_element(lengths) - lengths.begin());
}

template <class Ball, class WeightedPoint, class BallOf>
void add_balls(std::span<WeightedPoint> points, const BallOf& ball_of, std::vector<Ball>& balls) {
  const std::size_t own = balls.size();
  balls.push_back(ball_of(std::span<const WeightedPoint>(points)));
  if (points.size() == 1) return;
  const int longest = longest_direction(std::span<const WeightedPoint>(points));
  const std::size_t half = points.size() / 2;
  std::ranges::nth_element(points, points.begin() + static_cast<std::ptrdiff_t>(half), {},
                           [longest](const WeightedPoint& point) { return point.place[longest]; });
  add_balls(points.first(half), ball_of, balls);
  balls[own].second = static_cast<std::uint32_t>(balls.size());
  add_balls(points.subspan(half), ball_of, balls);
}

/// The root is the first; `ball_of` makes one of some of the points. Precondition: at least one point.
template <class Ball, class WeightedPoint, class BallOf>
[[nodiscard]] std::vector<Ball> ball_tree(std::span<const WeightedPoint> points, const BallOf& ball_of) {
  std::vector<WeightedPoint> sorted(points.begin(), points.end());
  std::vector<Ball> balls;
  balls.reserve(2 * points.size());
  add_balls(std::span(sorted), ball_of, balls);
  return balls;
}

/// Visits the balls from the root; goes on to the children of each ball for which `visit` returns true.
template <class Ball, class Visit>
void visit_balls(std::span<const Ball> balls, const Visit& visit) {
  std::array<std::uint32_t, 64> waiting{};  // more than the tree is high
  std::size_t count = 1;
  while (count > 0) {
    const std::uint32_t index = waiting[--count];
    if (!visit(balls[index])) continue;
    waiting[count++] = balls[index].second;
    waiting[count++] = index + 1;
  }
}

// Weighted points in a tree of balls: bounds of sums over many points ask few of the balls.

/// A point and its weight, which is not negative.
struct PointOfWeight {
  Point place;
  double weight;
};

/// All points of a ball; all but the centre rounded up.
struct WeightedBall {
  Point centre;
  double radius;
  double weight;         ///< the weight of all points
  double moment;         ///< |Σ weight (point - centre)|
  std::uint32_t second;  ///< index of the second child; the first follows its parent; 0: a single point, the centre
};

/// The root is the first. Precondition: at least one point, finite.
[[nodiscard]] std::vector<WeightedBall> weighted_balls(std::span<const PointOfWeight> points);

// Bounds the objective, in intervals, over all poses of a box that keep the limit (docs/mathematics.md §24).

/// The bounded objective: Σ weight f(distance of a point), for poses in which no point lies deeper than the limit.
struct BoundedObjective {
  Fitness fitness;
  double penetration_limit;
  std::vector<WeightedBall> balls;  ///< of all points
};

struct BoxBound {
  double upper;  ///< proven for every pose of the box that keeps the limit; -infinity: no pose keeps it
  std::array<double, pose_parameters> spread;  ///< about each direction's contribution to `upper`: the direction with
                                               ///< the widest is to be divided
};

/// The bound for one implant. Any number of threads may call it.
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
