/// Weights are multiples of a power of two: halving an edge is exact, and only points are rounded.
#include "verify/sets/triangle_pieces.hpp"

#include <algorithm>
#include <cmath>

#include "verify/analysis/largest_coordinate.hpp"
#include "verify/numbers/vector.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

constexpr double kUnitOfWeights = 0x1p-50;  // three of them and their sums are binary64 numbers

bool is_whole(double weight) {
  const double units = weight / kUnitOfWeights;
  return units == std::floor(units);
}

double rounded_down(double weight) {
  return kUnitOfWeights * std::floor(std::clamp(weight, 0.0, 1.0) / kUnitOfWeights);
}

double way_up(const Point& a, const Point& b) {
  const auto along = [&](std::size_t i) { return Interval(a[i]) - Interval(b[i]); };
  return length<double>(Vector3<double>(along(0), along(1), along(2))).upper();
}

}  // namespace

std::optional<std::array<Piece, 2>> halves(const Piece& piece, std::size_t edge) {
  const std::size_t next = (edge + 1) % 3;
  const Weights middle{0.5 * (piece[edge][0] + piece[next][0]), 0.5 * (piece[edge][1] + piece[next][1])};
  if (!is_whole(middle[0]) || !is_whole(middle[1])) return std::nullopt;
  std::array<Piece, 2> result{piece, piece};
  result[0][next] = middle;
  result[1][edge] = middle;
  return result;
}

Weights rounded_into_triangle(const Weights& weights) {
  const double first = rounded_down(weights[0]);
  return {first, std::min(rounded_down(weights[1]), 1.0 - first)};
}

/// With w_0 = 1 - w_1 - w_2, at most two roundings of numbers up to 1, a coordinate is a sum of three products: in
/// units of 2^-53 of the largest coordinate, w_0 costs 2, the products 1 together, the sums 1 each. Three coordinates
/// are off by less than 9, where 32 are allowed; and by what products lose that underflow.
DividedTriangle::DividedTriangle(const Triangle& triangle)
    : triangle_(triangle),
      error_(add(multiply(0x1p-48, largest_coordinate(triangle), Direction::up), 0x1p-1060, Direction::up)) {}

Point DividedTriangle::point(const Weights& weights) const {
  const double first = (1.0 - weights[0]) - weights[1];
  Point result{};
  for (std::size_t i = 0; i < 3; ++i)
    result[i] = first * triangle_[0][i] + weights[0] * triangle_[1][i] + weights[1] * triangle_[2][i];
  return result;
}

Triangle DividedTriangle::corners(const Piece& piece) const {
  return {point(piece[0]), point(piece[1]), point(piece[2])};
}

double DividedTriangle::lower_by_ball(const Triangle& corners, const Point& centre, double lo) const {
  if (!(lo > -infinity)) return -infinity;
  double radius = 0.0;
  for (const Point& corner : corners) radius = std::max(radius, way_up(corner, centre));
  return subtract(lo, add(radius, error_, Direction::up), Direction::down);
}

double DividedTriangle::upper_by_point(double hi) const {
  return std::max(0.0, add(hi, error_, Direction::up));
}

}  // namespace verisq::verify
