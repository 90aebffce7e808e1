/// Halved at the median of the middles along the longest side of their box; searched nearest box first.
#include "verify/deviation/triangle_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "verify/deviation/triangle_distance_bounds.hpp"
#include "verify/numbers/rounding.hpp"

namespace verisq::verify {

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

/// Of the squared distance from a box, from below: differences, squares and sums are of one sign and round by less than
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
    double squared;  ///< no triangle in it is nearer
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

bool TriangleTree::alone(const Point& point, double reach, std::uint32_t n) const {
  const double squared_reach = multiply(reach, reach, Direction::up);
  std::array<std::uint32_t, deepest> open{};
  std::size_t size = 0;
  open[size++] = 0;
  while (size > 0) {
    const std::uint32_t place = open[--size];
    const Node& node = nodes_[place];
    if (squared_distance_down(point, node.lower, node.upper) > squared_reach) continue;
    for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
      if (k != n && !(distance_from_triangle(point, triangles_[k]).lo > reach)) return false;
    }
    if (node.count > 0) continue;
    open[size++] = node.first;
    open[size++] = place + 1;
  }
  return true;
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

}  // namespace verisq::verify
