/// Signs of determinants in binary64 intervals; a segment that passes an edge too closely is replaced by another one.
#include "verify/containment/closed_surface.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "verify/analysis/largest_coordinate.hpp"
#include "verify/numbers/interval.hpp"

namespace verisq::verify {

namespace {

/// Of the segments: how far they go in x and y for 1 in z. Nothing depends on their choice but whether the answer is
/// found; small slopes keep their boxes thin, odd ones keep them off the edges of regular meshes.
constexpr std::array<std::array<double, 2>, 6> slopes{
    {{0.0123, 0.0217}, {-0.0311, 0.0173}, {0.0271, -0.0397}, {-0.0149, -0.0091}, {0.0613, 0.0447}, {-0.0829, 0.0551}}};

/// Products of three differences are far from overflow.
constexpr double largest_size = 1e100;

/// How a segment meets a triangle.
enum class Crossing : std::uint8_t { none, outward, inward };

enum class Sign : std::uint8_t { negative, positive, unknown };

Sign sign_of(const Interval& x) {
  if (x.lower() > 0.0) return Sign::positive;
  return x.upper() < 0.0 ? Sign::negative : Sign::unknown;
}

std::array<Interval, 3> way(const Point& from, const Point& to) {
  return {Interval(to[0]) - Interval(from[0]), Interval(to[1]) - Interval(from[1]),
          Interval(to[2]) - Interval(from[2])};
}

/// Of six times the volume of the tetrahedron.
Sign orientation(const Point& a, const Point& b, const Point& c, const Point& d) {
  const auto u = way(a, b);
  const auto v = way(a, c);
  const auto w = way(a, d);
  return sign_of(u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) +
                 u[2] * (v[0] * w[1] - v[1] * w[0]));
}

bool boxes_meet(const Point& from, const Point& to, const Triangle& triangle) {
  for (std::size_t i = 0; i < 3; ++i) {
    const auto [low, high] = std::minmax({triangle[0][i], triangle[1][i], triangle[2][i]});
    if (std::max(from[i], to[i]) < low || std::min(from[i], to[i]) > high) return false;
  }
  return true;
}

/// Of the triangle's inside; nothing where the segment may touch its boundary or end on it.
std::optional<Crossing> crossing(const Point& from, const Point& to, const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  const std::array around{orientation(from, to, a, b), orientation(from, to, b, c), orientation(from, to, c, a)};
  // The line meets the closed triangle only where none is positive or none is negative.
  if (std::ranges::count(around, Sign::positive) > 0 && std::ranges::count(around, Sign::negative) > 0) {
    return Crossing::none;
  }
  const Sign side_of_from = orientation(a, b, c, from);
  const Sign side_of_to = orientation(a, b, c, to);
  if (side_of_from == Sign::unknown || side_of_to == Sign::unknown) return std::nullopt;
  if (side_of_from == side_of_to) return Crossing::none;
  if (std::ranges::count(around, Sign::unknown) > 0) return std::nullopt;
  return side_of_to == Sign::positive ? Crossing::outward : Crossing::inward;  // where the normal points
}

}  // namespace

ClosedSurface::ClosedSurface(std::vector<Triangle> triangles)
    : triangles_(std::move(triangles)), lower_(triangles_[0][0]), upper_(lower_) {
  for (const Triangle& triangle : triangles_) {
    for (const Point& corner : triangle) {
      for (std::size_t i = 0; i < 3; ++i) {
        lower_[i] = std::min(lower_[i], corner[i]);
        upper_[i] = std::max(upper_[i], corner[i]);
      }
    }
  }
}

std::optional<bool> ClosedSurface::odd(const Point& point) const {
  const std::optional<Crossings> found = crossings(point);
  if (!found) return std::nullopt;
  return (found->outward + found->inward) % 2 == 1;
}

std::optional<int> ClosedSurface::winding_number(const Point& point) const {
  const std::optional<Crossings> found = crossings(point);
  if (!found) return std::nullopt;
  return found->outward - found->inward;
}

std::optional<int> ClosedSurface::winding_change(const Point& begin, const Point& end,
                                                 std::span<const std::uint32_t> triangles) const {
  if (largest_coordinate(Triangle{lower_, upper_, begin}) > largest_size || largest_coordinate(end) > largest_size) {
    return std::nullopt;
  }
  int change = 0;
  for (const std::uint32_t n : triangles) {
    if (!boxes_meet(begin, end, triangles_[n])) continue;
    const std::optional<Crossing> found = crossing(begin, end, triangles_[n]);
    if (!found) return std::nullopt;
    if (*found == Crossing::outward) --change;
    if (*found == Crossing::inward) ++change;
  }
  return change;
}

std::optional<ClosedSurface::Crossings> ClosedSurface::crossings(const Point& point) const {
  for (std::size_t i = 0; i < 3; ++i) {
    if (point[i] < lower_[i] || point[i] > upper_[i]) return Crossings{};
  }
  if (largest_coordinate(Triangle{lower_, upper_, point}) > largest_size) return std::nullopt;
  for (const auto& [slope_x, slope_y] : slopes) {
    const double height = 2.0 * (upper_[2] - point[2]) + (upper_[2] - lower_[2]);
    const Point to{point[0] + slope_x * height, point[1] + slope_y * height, point[2] + height};
    if (!(to[2] > upper_[2])) return std::nullopt;  // only then it is outside
    if (const std::optional<Crossings> found = crossings(point, to)) return found;
  }
  return std::nullopt;
}

std::optional<ClosedSurface::Crossings> ClosedSurface::crossings(const Point& from, const Point& to) const {
  Crossings sum;
  for (const Triangle& triangle : triangles_) {
    if (!boxes_meet(from, to, triangle)) continue;
    const std::optional<Crossing> found = crossing(from, to, triangle);
    if (!found) return std::nullopt;
    if (*found == Crossing::outward) ++sum.outward;
    if (*found == Crossing::inward) ++sum.inward;
  }
  return sum;
}

}  // namespace verisq::verify
