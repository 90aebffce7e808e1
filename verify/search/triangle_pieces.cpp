/// This file implements triangle_pieces.hpp.
#include "verify/search/triangle_pieces.hpp"

#include <algorithm>
#include <cmath>

#include "verify/numbers/points.hpp"
#include "verify/numbers/vector.hpp"
#include "verify/proposals/support_mapping.hpp"
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

/// With w_0 = 1 - w_1 - w_2, at most two roundings of numbers up to 1, a coordinate is a sum of three products. In
/// units of 2^-53 of the largest coordinate, w_0 costs 2, the products 1 together, the sums 1 each. Three coordinates
/// are off by less than 9, where 32 are allowed; and by the underflow of products.
DividedTriangle::DividedTriangle(const Triangle& triangle, double lost)
    : triangle_(triangle),
      error_(add(multiply(0x1p-48, largest_coordinate(triangle), Direction::up), 0x1p-1060 + lost, Direction::up)) {}

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

namespace {

using InPlane = TriangleFrame::InPlane;

Point scaled(const Point& v, double s) {
  return along(Point{}, v, s);
}

double length_of(const Point& v) {
  return std::sqrt(dot(v, v));
}

/// Nothing for a vector without a direction.
std::optional<Point> unit_of(const Point& v) {
  const double size = length_of(v);
  if (!(size > 0.0) || !std::isfinite(size)) return std::nullopt;
  return scaled(v, 1.0 / size);
}

/// Any unit vector orthogonal to a unit vector.
Point across(const Point& u) {
  const std::size_t least = std::fabs(u[0]) < std::fabs(u[1]) ? (std::fabs(u[0]) < std::fabs(u[2]) ? 0 : 2)
                                                              : (std::fabs(u[1]) < std::fabs(u[2]) ? 1 : 2);
  Point axis{};
  axis[least] = 1.0;
  return unit_of(cross(u, axis)).value_or(axis);
}

double product(const InPlane& a, const InPlane& b) {
  return a[0] * b[0] + a[1] * b[1];
}

InPlane less(const InPlane& a, const InPlane& b) {
  return {a[0] - b[0], a[1] - b[1]};
}

/// The quadratic model: the distance at places relative to the look.
struct DistanceModel {
  InPlane slope;
  const Curvature& curvature;

  [[nodiscard]] double operator()(const InPlane& s) const {
    return product(slope, s) + 0.5 * product(s, curvature.times(s));
  }
};

using Barycentric = std::array<double, 3>;

/// A candidate for the least point.
struct PlaceOfLeast {
  Barycentric weights;
  double value;
};

InPlane at(const std::array<InPlane, 3>& corners, const Barycentric& b) {
  InPlane s{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 2; ++k) s[k] += b[i] * corners[i][k];
  return s;
}

/// The least point of the model on the edge from one corner to the next, if it is between them.
std::optional<Barycentric> least_on_edge(const DistanceModel& model, const std::array<InPlane, 3>& corners,
                                         std::size_t i) {
  const std::size_t j = (i + 1) % 3;
  const InPlane edge = less(corners[j], corners[i]);
  const InPlane image = model.curvature.times(edge);
  const double way = -(product(model.slope, edge) + product(corners[i], image)) / product(edge, image);
  if (!(way > 0.0 && way < 1.0)) return std::nullopt;
  Barycentric b{};
  b[i] = 1.0 - way;
  b[j] = way;
  return b;
}

/// The point at which the model's gradient vanishes, if it is in the piece.
std::optional<Barycentric> least_within(const DistanceModel& model, const std::array<InPlane, 3>& corners) {
  const InPlane u = less(corners[1], corners[0]);
  const InPlane v = less(corners[2], corners[0]);
  const InPlane image_u = model.curvature.times(u);
  const InPlane image_v = model.curvature.times(v);
  const double uu = product(u, image_u);
  const double uv = product(u, image_v);
  const double vv = product(v, image_v);
  const double right_u = -(product(model.slope, u) + product(corners[0], image_u));
  const double right_v = -(product(model.slope, v) + product(corners[0], image_v));
  const double determinant = uu * vv - uv * uv;
  const double first = (right_u * vv - right_v * uv) / determinant;
  const double second = (right_v * uu - right_u * uv) / determinant;
  if (!(determinant > 0.0 && first > 0.0 && second > 0.0 && first + second < 1.0)) return std::nullopt;
  return Barycentric{1.0 - first - second, first, second};
}

}  // namespace

TriangleFrame::TriangleFrame(const Triangle& triangle) : origin_(triangle[0]) {
  const Point first = difference(triangle[1], triangle[0]);
  const Point second = difference(triangle[2], triangle[0]);
  const bool by_first = length_of(first) >= length_of(second);
  const Point along_edge = unit_of(by_first ? first : second).value_or(Point{1.0, 0.0, 0.0});
  const Point& other = by_first ? second : first;
  const Point rest = along(other, along_edge, -dot(other, along_edge));
  const bool flat = !(length_of(rest) > 1e-14 * length_of(other));  // a segment, or a point
  const Point in_plane = flat ? across(along_edge) : unit_of(rest).value_or(across(along_edge));
  axes_ = {along_edge, in_plane, cross(along_edge, in_plane)};
}

Triangle TriangleFrame::probes(const Point& at, double step) const {
  return {along(at, axes_[0], step), along(at, axes_[1], step), along(at, axes_[2], step)};
}

std::optional<Point> TriangleFrame::direction(double at, const std::array<double, 3>& at_probes, double step) const {
  Point gradient{};
  for (std::size_t i = 0; i < 3; ++i) gradient = along(gradient, axes_[i], (at_probes[i] - at) / step);
  return unit_of(gradient);
}

InPlane TriangleFrame::place(const Point& x) const {
  return part_in_plane(difference(x, origin_));
}

InPlane TriangleFrame::part_in_plane(const Point& direction) const {
  return {dot(axes_[0], direction), dot(axes_[1], direction)};
}

InPlane Curvature::times(const InPlane& v) const {
  return {product(rows_[0], v), product(rows_[1], v)};
}

void Curvature::learn(const TriangleFrame& frame, const Look& from, const Look& to) {
  const InPlane step = less(frame.place(to.at), frame.place(from.at));
  const InPlane change = less(frame.part_in_plane(to.direction), frame.part_in_plane(from.direction));
  const InPlane expected = times(step);
  const double seen = product(step, change);
  const double known = product(step, expected);
  // If the distance curves downwards, or hardly at all, the least point is elsewhere: some positive number serves.
  constexpr double least_part = 1e-3;
  if (!(known > 0.0) || !std::isfinite(seen)) return;
  const double kept = std::max(seen, least_part * known);
  const double part = seen < kept ? (known - kept) / (known - seen) : 1.0;  // Powell's damping
  const InPlane damped{part * change[0] + (1.0 - part) * expected[0], part * change[1] + (1.0 - part) * expected[1]};
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j) rows_[i][j] += damped[i] * damped[j] / kept - expected[i] * expected[j] / known;
}

LeastPoint least_point(const TriangleFrame& frame, const Piece& piece, const Triangle& corners, const Look& about,
                       const Curvature& curvature) {
  const InPlane here = frame.place(about.at);
  std::array<InPlane, 3> places{};
  for (std::size_t i = 0; i < 3; ++i) places[i] = less(frame.place(corners[i]), here);
  const DistanceModel model{frame.part_in_plane(about.direction), curvature};
  PlaceOfLeast best{{1.0, 0.0, 0.0}, infinity};
  const auto offer = [&](const Barycentric& b) {
    const double value = model(at(places, b));
    if (value < best.value) best = {b, value};
  };
  for (std::size_t i = 0; i < 3; ++i) {
    Barycentric corner{};
    corner[i] = 1.0;
    offer(corner);
    if (const auto on_edge = least_on_edge(model, places, i)) offer(*on_edge);
  }
  if (const auto within = least_within(model, places)) offer(*within);
  Weights weights{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 2; ++k) weights[k] += best.weights[i] * piece[i][k];
  return {rounded_into_triangle(weights), -best.value};
}

namespace {

double farthest_corner(const Triangle& corners, const Point& x) {
  double largest = 0.0;
  for (const Point& corner : corners) largest = std::max(largest, length_of(difference(corner, x)));
  return largest;
}

/// Returns whether all corners are, along the direction, as far beyond the look as the aim requires.
bool is_beyond(const Triangle& corners, const Look& look, const Point& direction, double aim) {
  return std::ranges::all_of(
      corners, [&](const Point& corner) { return look.distance + dot(difference(corner, look.at), direction) >= aim; });
}

}  // namespace

ProvingDirections proving_directions(const TriangleFrame& frame, const Triangle& corners, const Look& look,
                                     double aim) {
  ProvingDirections found{{}, 0};
  const auto offer = [&](const std::optional<Point>& direction) {
    constexpr double nearly = 0.99;
    if (!direction || dot(*direction, look.direction) < nearly || !is_beyond(corners, look, *direction, aim)) return;
    found.directions[found.count++] = *direction;
  };
  offer(look.direction);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto edge = unit_of(difference(corners[(i + 1) % 3], corners[i]));
    if (edge) offer(unit_of(along(look.direction, *edge, -dot(look.direction, *edge))));
  }
  offer(scaled(frame.normal(), dot(frame.normal(), look.direction) < 0.0 ? -1.0 : 1.0));
  return found;
}

/// Along a direction beside the look's own the distance grows slower; at most half the squared sine is lost.
std::optional<ProvingBall> proving_ball(const Triangle& corners, const Look& look, const Point& direction, double aim,
                                        double reach) {
  const Point aside = difference(direction, look.direction);
  const double gain = 1.0 - 0.5 * dot(aside, aside);
  const double size = farthest_corner(corners, look.at);
  if (!(size > 0.0)) return std::nullopt;
  for (double way = 0.25 * size; way <= reach && std::isfinite(way); way *= 2.0) {
    const Point centre = along(look.at, direction, way);
    if (look.distance + gain * way - farthest_corner(corners, centre) >= aim) return ProvingBall{centre, way};
  }
  return std::nullopt;
}

}  // namespace verisq::verify
