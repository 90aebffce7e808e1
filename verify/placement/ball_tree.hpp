/// Trees of balls of weighted points, halved along the longest direction: how they are made, and walked.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace verisq::verify {

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

/// From the root, the children of those that `visit` returns true for.
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

}  // namespace verisq::verify
