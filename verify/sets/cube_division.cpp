/// Exactness is tested, not assumed: sums that round are refused.
#include "verify/sets/cube_division.hpp"

#include <algorithm>
#include <cmath>

#include "verify/numbers/vector.hpp"

namespace verisq::verify {

namespace {

bool covers(const Cube& cube, const Box& box) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(add(cube.centre[i], -cube.half_width, Direction::up) <= box.lower[i])) return false;
    if (!(add(cube.centre[i], cube.half_width, Direction::down) >= box.upper[i])) return false;
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

std::optional<Cube> root_cube(const Box& box) {
  double extent = 0.0;
  for (std::size_t i = 0; i < 3; ++i) extent = std::max(extent, box.upper[i] / 2 - box.lower[i] / 2);
  if (!std::isfinite(extent)) return std::nullopt;
  int exponent = 0;
  std::frexp(extent, &exponent);
  for (double half_width = std::ldexp(1.0, std::max(exponent, -1000)); std::isfinite(half_width); half_width *= 2) {
    Cube cube{{}, half_width};
    for (std::size_t i = 0; i < 3; ++i) {
      const double middle = box.lower[i] / 2 + box.upper[i] / 2;
      cube.centre[i] = std::nearbyint(middle / (half_width / 2)) * (half_width / 2);
    }
    if (covers(cube, box)) return cube;
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
