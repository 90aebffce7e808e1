/// Halves along the longest direction; radii, weights and moments by interval arithmetic.
#include "verify/best_fit/weighted_balls.hpp"

#include <algorithm>

#include "verify/numbers/vector.hpp"

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

std::size_t longest_direction(std::span<const PointOfWeight> points) {
  Point lower = points.front().place;
  Point upper = lower;
  for (const PointOfWeight& point : points) {
    for (std::size_t i = 0; i < 3; ++i) {
      lower[i] = std::min(lower[i], point.place[i]);
      upper[i] = std::max(upper[i], point.place[i]);
    }
  }
  std::size_t longest = 0;
  for (std::size_t i = 1; i < 3; ++i) {
    if (upper[i] - lower[i] > upper[longest] - lower[longest]) longest = i;
  }
  return longest;
}

void add_balls(std::span<PointOfWeight> points, std::vector<WeightedBall>& balls) {
  const std::size_t own = balls.size();
  balls.push_back(ball_of(points));
  if (points.size() == 1) return;
  const std::size_t longest = longest_direction(points);
  const std::size_t half = points.size() / 2;
  std::ranges::nth_element(points, points.begin() + static_cast<std::ptrdiff_t>(half), {},
                           [longest](const PointOfWeight& point) { return point.place[longest]; });
  add_balls(points.first(half), balls);
  balls[own].second = static_cast<std::uint32_t>(balls.size());
  add_balls(points.subspan(half), balls);
}

}  // namespace

std::vector<WeightedBall> weighted_balls(std::span<const PointOfWeight> points) {
  std::vector<PointOfWeight> sorted(points.begin(), points.end());
  std::vector<WeightedBall> balls;
  balls.reserve(2 * points.size());
  add_balls(sorted, balls);
  return balls;
}

}  // namespace verisq::verify
