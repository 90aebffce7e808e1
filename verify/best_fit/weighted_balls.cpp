/// Radii, weights and moments by interval arithmetic.
#include "verify/best_fit/weighted_balls.hpp"

#include <algorithm>

#include "verify/numbers/vector.hpp"
#include "verify/placement/ball_tree.hpp"

namespace verisq::verify {

namespace {

Vector3<double> exact(const Point& p) {
  return {Interval(p[0]), Interval(p[1]), Interval(p[2])};
}

/// About the centre of mass, in floating point: what is proven holds about any point.
Point middle_of(std::span<const PointOfWeight> points) {
  if (points.size() == 1) return points.front().place;
  double weight = 0.0;
  Point sum{};
  for (const PointOfWeight& point : points) {
    weight += point.weight;
    for (std::size_t i = 0; i < 3; ++i) sum[i] += point.weight * point.place[i];
  }
  if (!(weight > 0.0)) return points.front().place;
  return {sum[0] / weight, sum[1] / weight, sum[2] / weight};
}

WeightedBall ball_of(std::span<const PointOfWeight> points) {
  const Point centre = middle_of(points);
  Interval weight(0);
  Vector3<double> moment;
  double radius = 0.0;
  for (const PointOfWeight& point : points) {
    const Vector3<double> way = exact(point.place) - exact(centre);
    radius = std::max(radius, length<double>(way).upper());
    weight += Interval(point.weight);
    moment = moment + way * Interval(point.weight);
  }
  return {centre, radius, weight.upper(), length<double>(moment).upper(), 0};
}

}  // namespace

std::vector<WeightedBall> weighted_balls(std::span<const PointOfWeight> points) {
  return ball_tree<WeightedBall>(points, ball_of);
}

}  // namespace verisq::verify
