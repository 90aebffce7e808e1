/// Lipschitz continuity, and how middles round.
#include "verify/placement/quartered_triangle.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>

#include "verify/analysis/largest_coordinate.hpp"
#include "verify/analysis/length.hpp"
#include "verify/numbers/rounding.hpp"
#include "verisq/way_surface_certificate.hpp"

namespace verisq::verify {
namespace {

Point middle(const Point& a, const Point& b) {
  return {0.5 * a[0] + 0.5 * b[0], 0.5 * a[1] + 0.5 * b[1], 0.5 * a[2] + 0.5 * b[2]};
}

/// 1/√3 from above.
constexpr double covering_share = 0.5773502691896258;

}  // namespace

std::array<Triangle, 4> quarters(const Triangle& piece) {
  const auto& [a, b, c] = piece;
  const Point ab = middle(a, b);
  const Point bc = middle(b, c);
  const Point ca = middle(c, a);
  return {{{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {bc, ca, ab}}};
}

/// With M the triangle's largest coordinate and u = 2^-53, a middle rounds by u M in each coordinate, on top of what
/// its two ends are off on average: after k divisions a corner is off by at most √3 k u M, for k <= 20 less than 35 u M
/// < 2^-47 M; halves that underflow are off by less than the smallest normal number.
double quartering_error(const Triangle& whole) {
  static_assert(most_quarterings <= 20);
  return 0x1p-47 * largest_coordinate(whole) + std::numeric_limits<double>::min();
}

/// Differences round by 2^-53 of themselves, their length by 2^-50 (length.hpp): together less than 2^-48.
double distance_in_binary64_up(const Point& a, const Point& b) {
  return length(a[0] - b[0], a[1] - b[1], a[2] - b[2]) * (1.0 + 0x1p-48) + std::numeric_limits<double>::min();
}

/// Every point of a triangle is no farther from the nearest corner than the longest side over √3.
double least_on(const Triangle& whole, const std::array<double, 3>& at_vertices) {
  double longest = 0.0;
  for (std::size_t i = 0; i < 3; ++i)
    longest = std::max(longest, distance_in_binary64_up(whole[i], whole[(i + 1) % 3]));
  const double farthest = multiply(covering_share, longest, Direction::up);
  const double by_nearest = subtract(std::ranges::min(at_vertices), farthest, Direction::down);
  return std::max(least_on(whole, 0.0, whole, at_vertices), by_nearest);
}

/// |x - vertex| is convex in x, hence largest at a corner.
double least_on(const Triangle& piece, double off, const Triangle& whole, const std::array<double, 3>& at_vertices) {
  double least = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    double farthest = 0.0;
    for (const Point& corner : piece) farthest = std::max(farthest, distance_in_binary64_up(corner, whole[i]));
    least = std::max(least, subtract(at_vertices[i], add(farthest, off, Direction::up), Direction::down));
  }
  return least;
}

}  // namespace verisq::verify
