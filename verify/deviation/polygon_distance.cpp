/// The distance from one triangle is convex: on each part it is largest at a corner of the part, whatever the cuts are.
#include "verify/deviation/polygon_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "verify/analysis/largest_coordinate.hpp"
#include "verify/deviation/triangle_distance_bounds.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/proposals/triangle.hpp"

namespace verisq::verify {

namespace {

/// Each cut adds a corner at most.
constexpr std::size_t most_cuts = 12;
/// Parts that are cut.
constexpr int most_divisions = 12;

struct Polygon {
  std::array<Point, 3 + most_cuts> corners;
  std::size_t size;

  [[nodiscard]] std::span<const Point> points() const { return {corners.data(), size}; }
  void add(const Point& corner) { corners[size++] = corner; }
};

Point middle(const Polygon& polygon) {
  Point sum{};
  for (const Point& corner : polygon.points()) {
    for (std::size_t i = 0; i < 3; ++i) sum[i] += corner[i] / static_cast<double>(polygon.size);
  }
  return sum;
}

double farthest_corner(const Polygon& polygon, const Triangle& triangle) {
  double farthest = 0.0;
  for (const Point& corner : polygon.points()) {
    farthest = std::max(farthest, distance_from_triangle_up(corner, triangle));
  }
  return farthest;
}

Point between(const Point& a, const Point& b, double share) {
  Point point;
  for (std::size_t i = 0; i < 3; ++i) point[i] = (1.0 - share) * a[i] + share * b[i];
  return point;
}

/// Parts of a polygon on both sides of a plane, each of which may be empty.
struct Cut {
  Polygon inside{{}, 0};
  Polygon outside{{}, 0};
};

/// The sides are told by rounded numbers: where these change their sign twice, the parts are those beside the chord
/// between two points of the boundary, whatever the plane is; where they do not, all is one part.
Cut cut(const Polygon& polygon, const Point& on_plane, const Point& inward) {
  std::array<double, 3 + most_cuts> heights{};
  std::size_t changes = 0;
  for (std::size_t i = 0; i < polygon.size; ++i) heights[i] = dot(inward, difference(polygon.corners[i], on_plane));
  for (std::size_t i = 0; i < polygon.size; ++i) {
    changes += (heights[i] >= 0.0) != (heights[(i + 1) % polygon.size] >= 0.0) ? 1 : 0;
  }
  Cut parts;
  if (changes != 2) {
    (heights[0] >= 0.0 ? parts.inside : parts.outside) = polygon;
    return parts;
  }
  for (std::size_t i = 0; i < polygon.size; ++i) {
    const std::size_t next = (i + 1) % polygon.size;
    const bool is_inside = heights[i] >= 0.0;
    (is_inside ? parts.inside : parts.outside).add(polygon.corners[i]);
    if (is_inside == (heights[next] >= 0.0)) continue;
    const double share = heights[i] / (heights[i] - heights[next]);
    const Point crossing =
        between(polygon.corners[i], polygon.corners[next], share >= 0.0 ? std::min(share, 1.0) : 0.5);
    parts.inside.add(crossing);
    parts.outside.add(crossing);
  }
  return parts;
}

class Division {
 public:
  Division(const TriangleTree& triangles, double enough) : triangles_(triangles), enough_(enough) {}

  /// Where that comes not below `enough` soon, the bound by the triangle n alone.
  double farthest(const Polygon& polygon, std::uint32_t n) {
    const Triangle& triangle = triangles_.triangle(n);
    const double whole = farthest_corner(polygon, triangle);
    if (whole <= enough_) return whole;
    if (++divisions_ > most_divisions) return whole;
    const Point normal = cross(difference(triangle[1], triangle[0]), difference(triangle[2], triangle[0]));
    Polygon rest = polygon;
    double farthest_part = 0.0;
    for (std::size_t side = 0; side < 3 && rest.size > 0; ++side) {
      const Point& from = triangle[side];
      if (rest.size + 1 > rest.corners.size()) return whole;
      const Cut parts = cut(rest, from, cross(normal, difference(triangle[(side + 1) % 3], from)));
      rest = parts.inside;
      if (parts.outside.size == 0) continue;
      const std::uint32_t other = triangles_.nearest(middle(parts.outside)).triangle;
      // Over itself again: it was cut off by rounding, or lies beyond the mesh's rim.
      const double part = other == n ? farthest_corner(parts.outside, triangle) : farthest(parts.outside, other);
      farthest_part = std::max(farthest_part, part);
      if (!(farthest_part <= enough_)) return whole;
    }
    if (rest.size > 0) farthest_part = std::max(farthest_part, farthest_corner(rest, triangle));
    return std::min(whole, farthest_part);
  }

 private:
  const TriangleTree& triangles_;
  double enough_;
  int divisions_ = 0;
};

}  // namespace

double farthest_of_polygon(std::span<const Point, 3> corners, const TriangleTree& triangles, std::uint32_t first,
                           double enough) {
  Polygon polygon{{}, 0};
  double largest = 0.0;
  for (const Point& corner : corners) {
    polygon.add(corner);
    largest = std::max(largest, largest_coordinate(corner));
  }
  // A crossing rounds by at most 4 u M a coordinate, M the largest coordinate, on top of what its ends are off: after
  // thrice most_divisions cuts it is off by less than 2^-44 M.
  const double displacement = 0x1p-44 * largest;
  const double inner = subtract(enough, displacement, Direction::down);
  return add(Division(triangles, inner).farthest(polygon, first), displacement, Direction::up);
}

}  // namespace verisq::verify
