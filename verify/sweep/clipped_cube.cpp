/// Tetrahedra are divided at a plane; those on its far side are dropped.
///
/// What that loses, with u = 2^-53, in a cube |e_i| <= 1. The plane has |offset| < |n|_1, or else nothing is divided.
/// A height n·e - offset is computed to 11 u |n|_1. A new vertex lies on its edge to 6 u in each coordinate, and on the
/// plane to (11 + 6 + 6) u |n|_1: by its heights, by the quotient, by its coordinates. |n|_1 <= sqrt(3) |n|, so that
/// all of a kept tetrahedron lies no more than 40 u beyond the plane, all of a dropped one no more than 40 u before it.
/// The difference of sets between what is kept of a tetrahedron and what should be is then at most
///   the slab: 80 u times the largest section of the cube, 4 sqrt(2) < 5.7, less than 456 u;
///   the moved vertices, by 11 u: of each part 11 u times its surface, 4 triangles of at most 3.5, less than 154 u;
///   three parts on the kept side, three on the dropped one: less than 456 u + 6 * 154 u < 2^11 u = 2^-42.
/// These are differences of sets (of densities, where moved tetrahedra overlap), so that those of several planes add
/// up. The volume of a tetrahedron is a determinant of differences of at most 2: 6 products below 8, each rounded five
/// times, over 6: to 40 u; their sum, of less than 9, to 9 u for each. Less than 2^-42 a tetrahedron, again.
#include "verify/sweep/clipped_cube.hpp"

#include <algorithm>
#include <cmath>

#include "verify/numbers/rounding.hpp"

namespace verisq::verify {
namespace {

constexpr double error_of_tetrahedron = 0x1p-42;
/// Twice the largest section of the cube |e_i| <= 1.
constexpr double two_sections = 12.0;

double height(const Point& x, const Point& normal, double offset) {
  return normal[0] * x[0] + normal[1] * x[1] + normal[2] * x[2] - offset;
}

/// Where the edge from a to b meets the plane. Precondition: one of the heights is positive, the other is not.
Point crossing(const Point& a, double height_a, const Point& b, double height_b) {
  const double share = height_a / (height_a - height_b);
  Point x;
  for (std::size_t i = 0; i < 3; ++i) x[i] = std::clamp(a[i] + share * (b[i] - a[i]), -1.0, 1.0);
  return x;
}

double volume_of(const std::array<Point, 4>& corners) {
  std::array<Point, 3> way;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < 3; ++i) way[k][i] = corners[k + 1][i] - corners[0][i];
  const auto& [u, v, w] = way;
  return std::abs(u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) +
                  u[2] * (v[0] * w[1] - v[1] * w[0])) /
         6.0;
}

/// Of a prism between the triangles p and q.
void add_prism(std::vector<std::array<Point, 4>>& tetrahedra, const std::array<Point, 3>& p,
               const std::array<Point, 3>& q) {
  tetrahedra.push_back({p[0], p[1], p[2], q[2]});
  tetrahedra.push_back({p[0], p[1], q[1], q[2]});
  tetrahedra.push_back({p[0], q[0], q[1], q[2]});
}

}  // namespace

CuttingPlane opposite(const CuttingPlane& plane) {
  const auto& [n, offset, error] = plane;
  return {{-n[0], -n[1], -n[2]}, -offset, error};
}

double reach_up(const Point& normal, double half_width) {
  double sum = 0.0;  // rounded up: sum of nonnegative terms
  for (const double n : normal) sum = add(sum, std::abs(n), Direction::up);
  return multiply(sum, half_width, Direction::up);
}

ClippedCube::ClippedCube(double half_width) : half_width_(half_width) {
  // From the corner (-1, -1, -1) to (1, 1, 1) along the axes, in each of their orders.
  std::array<std::size_t, 3> order{0, 1, 2};
  do {
    Tetrahedron& corners = tetrahedra_.emplace_back();
    corners.fill({-1.0, -1.0, -1.0});
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t later = k + 1; later < 4; ++later) corners[later][order[k]] = 1.0;
  } while (std::ranges::next_permutation(order).found);
}

void ClippedCube::clip(const CuttingPlane& plane) {
  const Point& n = plane.normal;
  const double largest = std::max({std::abs(n[0]), std::abs(n[1]), std::abs(n[2])});  // no more than |n|
  const double reach = reach_up(n, 1.0);
  const double offset = plane.offset / half_width_;  // exact, but for underflow, which is far below what is added
  const double error = divide(plane.error, half_width_, Direction::up);
  // Whatever the error, all of the cube is kept, or none.
  if (subtract(offset, error, Direction::down) >= reach) return;
  if (add(offset, error, Direction::up) <= -reach) {
    tetrahedra_.clear();
    return;
  }
  const double thickness = divide(error, largest, Direction::up);
  error_ = add(error_, multiply(two_sections, thickness, Direction::up), Direction::up);
  std::vector<Tetrahedron> kept;
  kept.reserve(tetrahedra_.size());
  for (const Tetrahedron& whole : tetrahedra_) {
    std::array<std::size_t, 4> order{0, 1, 2, 3};
    std::array<double, 4> heights;
    for (std::size_t k = 0; k < 4; ++k) heights[k] = height(whole[k], n, offset);
    auto* const beyond = std::partition(order.begin(), order.end(), [&](std::size_t k) { return heights[k] <= 0.0; });
    const auto before = beyond - order.begin();
    const auto corner = [&](std::size_t k) { return whole[order[k]]; };
    const auto cut = [&](std::size_t from, std::size_t to) {
      return crossing(whole[order[from]], heights[order[from]], whole[order[to]], heights[order[to]]);
    };
    switch (before) {
      case 1: kept.push_back({corner(0), cut(0, 1), cut(0, 2), cut(0, 3)}); break;
      case 2: add_prism(kept, {corner(0), cut(0, 2), cut(0, 3)}, {corner(1), cut(1, 2), cut(1, 3)}); break;
      case 3: add_prism(kept, {corner(0), corner(1), corner(2)}, {cut(0, 3), cut(1, 3), cut(2, 3)}); break;
      case 4: kept.push_back(whole); break;
      default: break;
    }
  }
  error_ = add(error_, static_cast<double>(tetrahedra_.size()) * error_of_tetrahedron, Direction::up);
  tetrahedra_ = std::move(kept);
}

Enclosure ClippedCube::volume() const {
  double sum = 0.0;
  for (const Tetrahedron& corners : tetrahedra_) sum += volume_of(corners);
  const double error = add(error_, static_cast<double>(tetrahedra_.size()) * error_of_tetrahedron, Direction::up);
  const double cubed = half_width_ * half_width_ * half_width_;  // exact
  return {std::clamp(subtract(sum, error, Direction::down), 0.0, 8.0) * cubed,
          std::clamp(add(sum, error, Direction::up), 0.0, 8.0) * cubed};
}

}  // namespace verisq::verify
