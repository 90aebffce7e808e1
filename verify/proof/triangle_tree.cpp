/// This file implements triangle_tree.hpp.
#include "verify/proof/triangle_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <tuple>
#include <utility>

#include "verify/numbers/points.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/proposals/support_mapping.hpp"

namespace verisq::verify {

namespace {

/// More than underflow in any of the sums here may cost: roots of less than 2^-1000.
constexpr double underflow = 0x1p-500;

/// Shares of the second and the third corner.
struct Weights {
  double b;
  double c;
};

/// Ericson, Real-Time Collision Detection (2005), 5.1.5: finds which of the corners, edges and the face is nearest.
/// Every result, NaN included, is clamped into the triangle.
Weights near_weights(const Point& p, const Triangle& triangle) {
  const Point ab = difference(triangle[1], triangle[0]);
  const Point ac = difference(triangle[2], triangle[0]);
  const Point ap = difference(p, triangle[0]);
  const double d1 = dot(ab, ap);
  const double d2 = dot(ac, ap);
  if (d1 <= 0.0 && d2 <= 0.0) return {0.0, 0.0};
  const Point bp = difference(p, triangle[1]);
  const double d3 = dot(ab, bp);
  const double d4 = dot(ac, bp);
  if (d3 >= 0.0 && d4 <= d3) return {1.0, 0.0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return {d1 / (d1 - d3), 0.0};
  const Point cp = difference(p, triangle[2]);
  const double d5 = dot(ab, cp);
  const double d6 = dot(ac, cp);
  if (d6 >= 0.0 && d5 <= d6) return {0.0, 1.0};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return {0.0, d2 / (d2 - d6)};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 >= d3 && d5 >= d6) {
    const double share = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {1.0 - share, share};
  }
  const double sum = va + vb + vc;
  return {vb / sum, vc / sum};
}

/// The share of `to` at the point of a segment nearest to p; 0 for NaN.
double near_share(const Point& p, const Point& from, const Point& to) {
  const Point way = difference(to, from);
  const double share = dot(difference(p, from), way) / dot(way, way);
  return share > 0.0 ? std::min(share, 1.0) : 0.0;
}

Weights clamped(const Weights& weights) {
  const double b = weights.b > 0.0 ? std::min(weights.b, 1.0) : 0.0;
  const double c = weights.c > 0.0 ? std::min(weights.c, 1.0 - b) : 0.0;
  return {b, c};
}

/// The point is off the exact point of these weights by less than 2^-48 M, M the triangle's largest coordinate. The
/// weights are exactly in [0, 1] with a sum of at most 1 + u. The two differences and products of at most 2M round by u
/// each; the sums, one of which is at most 3M large, by u each. The excess of the sum over 1 adds 2uM: less than 16uM a
/// coordinate.
Point point_at(const Triangle& triangle, const Weights& weights) {
  Point point;
  for (std::size_t i = 0; i < 3; ++i) {
    const double a = triangle[0][i];
    point[i] = a + weights.b * (triangle[1][i] - a) + weights.c * (triangle[2][i] - a);
  }
  return point;
}

/// Differences of binary64 numbers, squares, sums and the root round by at most 8u in all, relative to the result.
double length_up(const Point& v) {
  return std::sqrt(dot(v, v)) * (1.0 + 0x1p-49) + underflow;
}

/// The triangle lies in {x : v·(point - x) >= least v·(point - corner)}, for any v. Each product is of two rounded
/// numbers; with their sum it is off by at most 5u of the sum of magnitudes. |v| from above and the quotient add 10u.
double lower_by(const Point& point, const Point& v, const Triangle& triangle) {
  double least = infinity;
  for (const Point& corner : triangle) {
    double sum = 0.0;
    double magnitude = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double product = v[i] * (point[i] - corner[i]);
      sum += product;
      magnitude += std::abs(product);
    }
    const double bound = sum - 0x1p-49 * magnitude;
    if (std::isnan(bound)) return 0.0;  // products beyond binary64: of this corner nothing is known
    least = std::min(least, bound);
  }
  const double lower = least / length_up(v) * (1.0 - 0x1p-49) - underflow;
  return lower > 0.0 && lower < infinity ? lower : 0.0;
}

struct Bounds {
  Enclosure distance;
  Point way;  ///< from the proposed point to the query
};

double upper_of(const Point& way, double displacement) {
  const double length = (length_up(way) + displacement) * (1.0 + 0x1p-52);
  return length >= 0.0 ? length : infinity;  // NaN is no bound
}

Bounds bounds_at(const Point& point, const Triangle& triangle, const Weights& weights, double displacement) {
  const Point way = difference(point, point_at(triangle, clamped(weights)));
  return {{lower_by(point, way, triangle), upper_of(way, displacement)}, way};
}

/// If the determinants of a needle cancel, the face gives no bound: its sides give better ones.
Enclosure with_sides(const Point& point, const Triangle& triangle, Enclosure distance, double displacement) {
  const auto& [a, b, c] = triangle;
  const double on_bc = near_share(point, b, c);
  const std::array sides{Weights{near_share(point, a, b), 0.0}, Weights{0.0, near_share(point, a, c)},
                         Weights{1.0 - on_bc, on_bc}};
  for (const Weights& side : sides) {
    const Enclosure at_side = bounds_at(point, triangle, side, displacement).distance;
    distance = {std::max(distance.lo, at_side.lo), std::min(distance.hi, at_side.hi)};
  }
  return distance;
}

double displacement_of(const Triangle& triangle) {
  return 0x1p-48 * largest_coordinate(triangle) + underflow;
}

}  // namespace

Enclosure distance_from_triangle(const Point& point, const Triangle& triangle) {
  const double displacement = displacement_of(triangle);
  const Enclosure distance = bounds_at(point, triangle, near_weights(point, triangle), displacement).distance;
  if (distance.hi - distance.lo <= 0x1p-20 * distance.hi + 4.0 * displacement) return distance;
  return with_sides(point, triangle, distance, displacement);
}

double distance_from_triangle_up(const Point& point, const Triangle& triangle) {
  return distance_from_triangle(point, triangle).hi;
}

namespace {

constexpr std::size_t most_in_a_leaf = 4;
/// Halving 2^32 triangles at their median is deep at most so often, and each level leaves one sibling behind.
constexpr std::size_t deepest = 64;

/// Thrice the middle, which sorts as well; scaled so that it does not overflow.
double middle(const Triangle& triangle, std::size_t axis) {
  return triangle[0][axis] / 3 + triangle[1][axis] / 3 + triangle[2][axis] / 3;
}

std::size_t longest_axis(std::span<const Triangle> triangles) {
  std::size_t longest = 0;
  double length = -1.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto by_axis = [axis](const Triangle& a, const Triangle& b) { return middle(a, axis) < middle(b, axis); };
    const auto [least, greatest] = std::ranges::minmax_element(triangles, by_axis);
    const double size = middle(*greatest, axis) / 2 - middle(*least, axis) / 2;
    if (size > length) {
      length = size;
      longest = axis;
    }
  }
  return longest;
}

/// The squared distance from a box, rounded down. Differences, squares and sums are of one sign and round by less than
/// 8u in all; underflow is less than 2^-1060.
double squared_distance_down(const Point& point, const Point& lower, const Point& upper) {
  double squares = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double outside = std::max({lower[i] - point[i], point[i] - upper[i], 0.0});
    squares += outside * outside;
  }
  return squares * (1.0 - 0x1p-49) - 0x1p-1060;
}

}  // namespace

TriangleTree::TriangleTree(std::vector<Triangle> triangles) : triangles_(std::move(triangles)) {
  nodes_.reserve(triangles_.size());
  build(triangles_, 0);
}

std::uint32_t TriangleTree::build(std::span<Triangle> triangles, std::uint32_t first) {
  Node node{triangles[0][0], triangles[0][0], first, static_cast<std::uint32_t>(triangles.size())};
  for (const Triangle& triangle : triangles) {
    for (const Point& corner : triangle) {
      for (std::size_t i = 0; i < 3; ++i) {
        node.lower[i] = std::min(node.lower[i], corner[i]);
        node.upper[i] = std::max(node.upper[i], corner[i]);
      }
    }
  }
  const auto place = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back(node);
  if (triangles.size() <= most_in_a_leaf) return place;

  const std::size_t axis = longest_axis(triangles);
  const std::size_t half = triangles.size() / 2;
  const auto by_axis = [axis](const Triangle& a, const Triangle& b) { return middle(a, axis) < middle(b, axis); };
  std::ranges::nth_element(triangles, triangles.begin() + static_cast<std::ptrdiff_t>(half), by_axis);
  build(triangles.first(half), first);
  const std::uint32_t second = build(triangles.subspan(half), first + static_cast<std::uint32_t>(half));
  nodes_[place].first = second;
  nodes_[place].count = 0;
  return place;
}

TriangleTree::Nearest TriangleTree::nearest(const Point& point) const {
  struct Branch {
    std::uint32_t node;
    double squared;  ///< no triangle in the box is nearer
  };
  const auto branch = [&](std::uint32_t node) {
    return Branch{node, squared_distance_down(point, nodes_[node].lower, nodes_[node].upper)};
  };
  Nearest found{{infinity, infinity}, 0};
  double farthest_squared = infinity;  // no less than the square of distance.hi
  std::array<Branch, deepest> open{};
  std::size_t size = 0;
  open[size++] = branch(0);
  while (size > 0) {
    const Branch next = open[--size];
    // Everything in it is at least as far as distance.hi, hence not nearer than distance.lo. False for infinity.
    if (next.squared > farthest_squared) continue;
    const Node& node = nodes_[next.node];
    for (std::uint32_t n = node.first; n < node.first + node.count; ++n) {
      const Enclosure distance = distance_from_triangle(point, triangles_[n]);
      found.distance.lo = std::min(found.distance.lo, distance.lo);
      if (distance.hi >= found.distance.hi) continue;
      found.distance.hi = distance.hi;
      found.triangle = n;
      farthest_squared = distance.hi * distance.hi * (1.0 + 0x1p-50) + 0x1p-1000;
    }
    if (node.count > 0) continue;
    const Branch first = branch(next.node + 1);
    const Branch second = branch(node.first);
    const bool first_is_nearer = first.squared <= second.squared;
    open[size++] = first_is_nearer ? second : first;
    open[size++] = first_is_nearer ? first : second;
  }
  return found;
}

template <class Passes, class Look>
bool TriangleTree::all_of(const Passes& passes, const Look& look) const {
  std::array<std::uint32_t, deepest> open{};
  std::size_t size = 0;
  open[size++] = 0;
  while (size > 0) {
    const std::uint32_t place = open[--size];
    const Node& node = nodes_[place];
    if (passes(node)) continue;
    for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
      if (!look(k)) return false;
    }
    if (node.count > 0) continue;
    open[size++] = node.first;
    open[size++] = place + 1;
  }
  return true;
}

bool TriangleTree::alone(const Point& point, double reach, std::uint32_t n) const {
  const double squared_reach = multiply(reach, reach, Direction::up);
  const auto is_beyond = [&](const Node& node) {
    return squared_distance_down(point, node.lower, node.upper) > squared_reach;
  };
  return all_of(is_beyond,
                [&](std::uint32_t k) { return k == n || distance_from_triangle(point, triangles_[k]).lo > reach; });
}

std::vector<std::uint32_t> TriangleTree::within(const Point& point, double reach) const {
  const double squared_reach = multiply(reach, reach, Direction::up);
  const auto is_beyond = [&](const Node& node) {
    return squared_distance_down(point, node.lower, node.upper) > squared_reach;
  };
  std::vector<std::uint32_t> found;
  all_of(is_beyond, [&](std::uint32_t k) {
    if (!(distance_from_triangle(point, triangles_[k]).lo > reach)) found.push_back(k);
    return true;
  });
  return found;
}

std::vector<std::uint32_t> TriangleTree::overlapping(const Point& lower, const Point& upper) const {
  const auto is_apart = [&](const Point& low, const Point& high) {
    for (std::size_t i = 0; i < 3; ++i) {
      if (low[i] > upper[i] || high[i] < lower[i]) return true;
    }
    return false;
  };
  std::vector<std::uint32_t> found;
  const auto look = [&](std::uint32_t k) {
    const auto& [a, b, c] = triangles_[k];
    Point low, high;
    for (std::size_t i = 0; i < 3; ++i) std::tie(low[i], high[i]) = std::minmax({a[i], b[i], c[i]});
    if (!is_apart(low, high)) found.push_back(k);
    return true;
  };
  all_of([&](const Node& node) { return is_apart(node.lower, node.upper); }, look);
  return found;
}

std::vector<Triangle> triangles_of(const Mesh& mesh) {
  std::vector<Triangle> triangles;
  triangles.reserve(mesh.triangles.empty() ? mesh.vertices.size() : mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    triangles.push_back({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]});
  }
  if (!mesh.triangles.empty()) return triangles;
  for (const Point& vertex : mesh.vertices) triangles.push_back({vertex, vertex, vertex});
  return triangles;
}

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

/// The parts of a polygon on both sides of a plane; each may be empty.
struct Cut {
  Polygon inside{{}, 0};
  Polygon outside{{}, 0};
};

/// Rounded numbers decide the sides. If these change their sign twice, the parts are the two parts beside the chord
/// between two points of the boundary, whatever the plane is. Else the whole polygon is one part.
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

  /// If the bound does not get below `enough` soon: the bound by the triangle n alone.
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
      // The part lies over the triangle n again: rounding cut it off, or it lies beyond the mesh's rim.
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
  for (const Point& corner : corners) polygon.add(corner);
  // A crossing rounds by at most 4 u M a coordinate, M the largest coordinate, on top of the error of its ends. After
  // thrice most_divisions cuts it is off by less than 2^-44 M. Underflow in it is below 2^-1060: the distances of
  // corners, which are rounded up by 2^-500, have room for that.
  const double displacement = 0x1p-44 * largest_coordinate(corners);
  const double inner = subtract(enough, displacement, Direction::down);
  return add(Division(triangles, inner).farthest(polygon, first), displacement, Direction::up);
}

}  // namespace verisq::verify
