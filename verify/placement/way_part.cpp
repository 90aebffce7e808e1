/// A way of length L between points l apart is nowhere farther than sqrt(L^2 - l^2) / 2 from the straight line between
/// them: it lies in the ellipsoid with these foci and the axis L (docs/mathematics.md §16).
#include "verify/placement/way_part.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "verify/analysis/distance_up.hpp"
#include "verify/analysis/finite_point.hpp"
#include "verify/numbers/rounding.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/posed_model.hpp"

namespace verisq::verify {
namespace {

double distance_down(const Point& x, const Point& y) {
  return length<Real>(PreciseVector(precise(x) - precise(y))).lower().to_double(Direction::down);
}

double sum_up(double a, double b) {
  return add(a, b, Direction::up);
}

/// How far a point anywhere in the ball may be from `x`.
double farthest(const PointBall& ball, const Point& x) {
  return sum_up(distance_up(ball.centre, x), ball.radius);
}

}  // namespace

Point seat_of(const Model& implant, std::span<const Pose> path) {
  const Point seat = implant.primitives.empty() ? Point{} : implant.primitives.front().pose.translation;
  return posed(seat, path.back());
}

Moment moment_of(const RigidPath& path, const Point& c, double time) {
  return {time, RigidPath::local_point(path.nearest_pose(time), c)};
}

bool is_finite(const PointBall& ball) {
  return is_finite(ball.centre) && std::isfinite(ball.radius);
}

Chord chord_of(const RigidPath& path, const Point& c, const Moment& begin, const Moment& end) {
  const PointBall& a = begin.place;
  const PointBall& b = end.place;
  const double way = path.length_up(c, begin.time, end.time);
  if (!is_finite(a) || !is_finite(b) || !std::isfinite(way)) return {begin, end, infinity};
  const double apart = subtract(distance_down(a.centre, b.centre), sum_up(a.radius, b.radius), Direction::down);
  const double chord = std::clamp(apart, 0.0, way);
  // (L - l) (L + l), of which the first factor alone is rounded by much of itself.
  const double product = multiply(subtract(way, chord, Direction::up), sum_up(way, chord), Direction::up);
  return {begin, end, multiply(0.5, square_root(product, Direction::up), Direction::up)};
}

// A point of the way is at most the bulge off a point x of the straight line from `begin` to `end`, and x no farther
// from the point of the segment that divides it alike than the farther of the ends from the segment's.
double offset_of(const Chord& chord, const std::array<Point, 2>& segment) {
  const auto& [first, last] = segment;
  if (!std::isfinite(chord.bulge) || !is_finite(first) || !is_finite(last)) return infinity;
  return sum_up(chord.bulge, std::max(farthest(chord.begin.place, first), farthest(chord.end.place, last)));
}

// All points of the segment are outside, and at least as far as the segment; and the signed distance changes by no more
// than a point moves.
double lower_end(const Checker& implant, const Chord& chord, const WayPart& part, double asked) {
  const double offset = offset_of(chord, part.segment);
  if (!std::isfinite(offset)) return -infinity;
  const auto& [first, last] = part.segment;
  const double far = std::max(sum_up(asked, offset), std::numeric_limits<double>::denorm_min());
  const double proven = implant(Triangle{first, last, last}, {far, infinity}, part.certificate).proven.lo;
  return proven > 0.0 ? subtract(proven, offset, Direction::down) : -infinity;
}

double upper_end(const Checker& implant, const PointBall& place, double asked, const Certificate& certificate) {
  if (!is_finite(place)) return infinity;
  const double of_centre = subtract(asked, place.radius, Direction::down);
  const double proven = implant(place.centre, {-infinity, of_centre}, certificate).proven.hi;
  return sum_up(proven, place.radius);
}

}  // namespace verisq::verify
