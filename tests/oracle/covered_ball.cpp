/// Subdivision of the cube around the ball, largest cubes first.
#include "tests/oracle/covered_ball.hpp"

#include <algorithm>
#include <cmath>
#include <deque>

#include "tests/oracle/reference_distance.hpp"

namespace verisq::oracle {

namespace {

[[nodiscard]] Point corner(const Point& centre, double half_edge, unsigned index) {
  Point result = centre;
  for (std::size_t k = 0; k < 3; ++k) result[k] += (index >> k & 1U) != 0 ? half_edge : -half_edge;
  return result;
}

/// Distance from the origin to the cube.
[[nodiscard]] double distance_to_cube(const Point& centre, double half_edge) {
  Point nearest;
  for (std::size_t k = 0; k < 3; ++k) nearest[k] = std::max(0.0, std::abs(centre[k]) - half_edge);
  return length(nearest);
}

}  // namespace

CoveredBall::CoveredBall(std::span<const Primitive> primitives) {
  for (const Primitive& primitive : primitives) solids_.emplace_back(primitive);
}

CoveredBall::Solid::Solid(const Primitive& primitive)
    : norm(primitive.superquadric), translation(primitive.pose.translation) {
  const PosedSolid turned(primitive.superquadric, {{0.0, 0.0, 0.0}, primitive.pose.quaternion});
  for (std::size_t k = 0; k < 3; ++k) {
    Vector unit{0, 0, 0};
    unit[k] = 1;
    const Point column = rounded(turned.to_own_frame(unit));
    for (std::size_t row = 0; row < 3; ++row) rows[row][k] = column[row];
  }
}

bool CoveredBall::Solid::contains_cube(const Point& centre, double half_edge) const {
  for (unsigned index = 0; index < 8; ++index) {
    const Point offset = difference(corner(centre, half_edge, index), translation);
    const Point local{dot(rows[0], offset), dot(rows[1], offset), dot(rows[2], offset)};
    if (!(norm.gauge(local) < 1 - 1e-9)) return false;
  }
  return true;
}

bool CoveredBall::inside_union(const Point& centre, double radius) const {
  constexpr int most_cubes = 30'000;
  struct Cube {
    Point offset;  ///< of its centre from the ball's
    double half_edge;
  };
  std::deque<Cube> cubes{{{0.0, 0.0, 0.0}, radius}};
  for (int seen = 0; !cubes.empty(); ++seen) {
    if (seen == most_cubes) return false;
    const Cube cube = cubes.front();
    cubes.pop_front();
    if (distance_to_cube(cube.offset, cube.half_edge) > radius) continue;
    const Point middle = difference(centre, scaled(cube.offset, -1.0));
    const auto contains = [&](const Solid& solid) { return solid.contains_cube(middle, cube.half_edge); };
    if (std::any_of(solids_.begin(), solids_.end(), contains)) continue;
    for (unsigned index = 0; index < 8; ++index) {
      cubes.push_back({corner(cube.offset, cube.half_edge / 2, index), cube.half_edge / 2});
    }
  }
  return true;
}

}  // namespace verisq::oracle
