/// Exactness is tested, not assumed: sums that round are refused.
#include "verify/sets/cube_division.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "verify/numbers/vector.hpp"
#include "verisq/octree_cube.hpp"

namespace verisq::verify {

namespace {

constexpr double centres_per_half_width = 1024.0;
constexpr int smallest_exponent = std::numeric_limits<double>::min_exponent + deepest_octree_level;
/// Above, corners overflow.
constexpr int largest_exponent = std::numeric_limits<double>::max_exponent - 3;

static_assert(smallest_exponent == -1001);  // smallest_root

bool keeps(const Cube& cube, const Box& box, const RootCubeRule& rule) {
  const double reach = (1.0 - rule.margin) * cube.half_width;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(std::fabs(cube.centre[i]) <= rule.farthest * cube.half_width)) return false;
    if (!(add(cube.centre[i], -reach, Direction::up) <= box.lower[i])) return false;
    if (!(add(cube.centre[i], reach, Direction::down) >= box.upper[i])) return false;
  }
  return true;
}

/// c + step where that is exact.
std::optional<double> exact_sum(double c, double step) {
  const double down = add(c, step, Direction::down);
  if (!std::isfinite(down) || down != add(c, step, Direction::up)) return std::nullopt;
  return down;
}

}  // namespace

std::optional<Cube> root_cube(const Box& box, const RootCubeRule& rule) {
  double largest = 0.0;
  for (std::size_t i = 0; i < 3; ++i) largest = std::max(largest, box.upper[i] - box.lower[i]);
  if (!std::isfinite(largest)) return std::nullopt;
  // A half-width of less than half the largest side holds nothing.
  const int first = largest > 0.0 ? std::max(std::ilogb(largest) - 1, smallest_exponent) : smallest_exponent;
  for (int exponent = first; exponent <= largest_exponent; ++exponent) {
    Cube cube{{}, std::ldexp(1.0, exponent)};
    const double grid = cube.half_width / centres_per_half_width;
    for (std::size_t i = 0; i < 3; ++i) {
      const double middle = 0.5 * box.lower[i] + 0.5 * box.upper[i];
      cube.centre[i] = std::nearbyint(middle / grid) * grid;
    }
    if (keeps(cube, box, rule)) return cube;
  }
  return std::nullopt;
}

std::optional<std::array<Cube, 8>> halves(const Cube& cube) {
  const double half = cube.half_width / 2;
  std::array<std::array<double, 2>, 3> centres{};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::optional<double> low = exact_sum(cube.centre[i], -half);
    const std::optional<double> high = exact_sum(cube.centre[i], half);
    if (!low || !high || half + half != cube.half_width) return std::nullopt;
    centres[i] = {*low, *high};
  }
  std::array<Cube, 8> result{};
  for (std::size_t n = 0; n < 8; ++n) {
    result[n] = {{centres[0][n & 1U], centres[1][(n >> 1U) & 1U], centres[2][n >> 2U]}, half};
  }
  return result;
}

bool contains(const Cube& cube, const Point& x) {
  for (std::size_t i = 0; i < 3; ++i) {
    // Decides exactly: no binary64 number lies between the exact difference and the rounded one.
    const Interval offset = abs(Interval(x[i]) - Interval(cube.centre[i]));
    if (!(offset.upper() <= cube.half_width)) return false;
  }
  return true;
}

Enclosure distance(const Point& x, const Cube& cube) {
  // Precise: squares of binary64 numbers may overflow.
  PreciseVector outside;
  for (std::size_t i = 0; i < 3; ++i) {
    const PreciseInterval beyond = abs(PreciseInterval(Real(x[i])) - PreciseInterval(Real(cube.centre[i]))) -
                                   PreciseInterval(Real(cube.half_width));
    outside[i] = {std::max(Real(0), beyond.lower()), std::max(Real(0), beyond.upper())};
  }
  const PreciseInterval length_outside = length<Real>(outside);
  return {length_outside.lower().to_double(Direction::down), length_outside.upper().to_double(Direction::up)};
}

Enclosure distance_to_faces(const Point& x, const Cube& cube) {
  Enclosure nearest{cube.half_width, cube.half_width};
  for (std::size_t i = 0; i < 3; ++i) {
    const Interval to_face = Interval(cube.half_width) - abs(Interval(x[i]) - Interval(cube.centre[i]));
    nearest = {std::min(nearest.lo, to_face.lower()), std::min(nearest.hi, to_face.upper())};
  }
  return {std::max(0.0, nearest.lo), std::max(0.0, nearest.hi)};
}

}  // namespace verisq::verify
