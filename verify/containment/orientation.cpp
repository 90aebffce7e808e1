/// Edges in order, and which way they are run through; the volume in intervals.
#include "verify/containment/orientation.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "verify/analysis/cross_product.hpp"
#include "verify/analysis/largest_coordinate.hpp"
#include "verify/numbers/vector.hpp"

namespace verisq::verify {

namespace {

/// Products of three differences stay far from overflow.
constexpr double largest_size = 1e100;

/// What encloses less of the cube about it encloses nothing, but for roundings, as of the mean that closes a rim.
constexpr double smallest_share = 1e-12;

/// About: only what is negligible depends on it.
double volume_of_cube_about(std::span<const Triangle> triangles) {
  double largest = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    double low = triangles[0][0][i];
    double high = low;
    for (const Triangle& triangle : triangles) {
      for (const Point& corner : triangle) {
        low = std::min(low, corner[i]);
        high = std::max(high, corner[i]);
      }
    }
    largest = std::max(largest, high - low);
  }
  return largest * largest * largest;
}

/// An edge as its two ends in order, and which way it is run through.
struct DirectedEdge {
  std::array<Point, 2> ends;
  int direction;
};

Vector3<double> way(const Point& from, const Point& to) {
  return {Interval(to[0]) - Interval(from[0]), Interval(to[1]) - Interval(from[1]),
          Interval(to[2]) - Interval(from[2])};
}

}  // namespace

bool is_closed(std::span<const Triangle> triangles) {
  std::vector<DirectedEdge> edges;
  for (const Triangle& triangle : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Point& from = triangle[k];
      const Point& to = triangle[(k + 1) % 3];
      if (from < to) edges.push_back({{from, to}, 1});
      if (to < from) edges.push_back({{to, from}, -1});
    }
  }
  std::ranges::sort(edges, {}, &DirectedEdge::ends);
  for (auto edge = edges.begin(); edge != edges.end();) {
    const std::array<Point, 2> ends = edge->ends;
    int sum = 0;
    for (; edge != edges.end() && edge->ends == ends; ++edge) sum += edge->direction;
    if (sum != 0) return false;
  }
  return true;
}

/// Six times the volume is the sum of those of the tetrahedra between the triangles and one point.
std::optional<int> orientation_of(std::span<const Triangle> triangles) {
  const auto is_large = [](const Triangle& triangle) { return largest_coordinate(triangle) > largest_size; };
  if (std::ranges::any_of(triangles, is_large)) return std::nullopt;
  const Point& from = triangles.front().front();
  Interval sum(0);
  for (const auto& [a, b, c] : triangles) sum += way(from, a).dot(cross(way(from, b), way(from, c)));
  const double least = 6.0 * smallest_share * volume_of_cube_about(triangles);
  if (sum.lower() > least) return 1;
  if (sum.upper() < -least) return -1;
  return std::nullopt;
}

}  // namespace verisq::verify
