/// The gauge is convex in x, so at no point of a tetrahedron above what lies linearly between its values at the
/// corners; the height above a plane that moves with the primitive is, at every time, linear in x, so the least of
/// several is concave, and nowhere below what lies between (docs/mathematics.md §23).
#include "verify/removed_volume/swept_primitive.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "verify/analysis/in_binary64.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/proof/posed_superquadric.hpp"
#include "verify/sweep/exact_vector.hpp"

namespace verisq::verify {
namespace {

using Eigen::Vector3d;

/// All points of the cube.
Vector3<double> range_of(const Cube& cube) {
  const Interval about(-cube.half_width, cube.half_width);
  return exact_vector(cube.centre) + Vector3<double>(about, about, about);
}

Vector3<double> corner_of(const Cube& cube, std::size_t k) {
  Vector3<double> corner = exact_vector(cube.centre);
  for (std::size_t i = 0; i < 3; ++i) corner[i] += Interval((k >> i & 1U) != 0 ? cube.half_width : -cube.half_width);
  return corner;
}

/// The smaller value at each corner.
void lower(CornerHeights& heights, const CornerHeights& others) {
  for (std::size_t k = 0; k < 8; ++k) heights[k] = Interval(std::min(heights[k].lower(), others[k].lower()));
}

bool all_positive(const CornerHeights& heights) {
  return std::ranges::all_of(heights, [](const Interval& height) { return height.lower() > 0.0; });
}

}  // namespace

/// The primitive at one time: from its own frame to that of the bone.
struct SweptPrimitive::Placement {
  Matrix3<double> rotation;
  Vector3<double> origin;
};

/// A plane that moves with the primitive, which lies behind it, during a part of a leg.
struct SweptPrimitive::Facing {
  CornerHeights heights;  ///< what is swept of the cube lies where they are not positive
  double sag;             ///< by which they were lowered, for what the plane does between begin and end
  double time;            ///< when the gauge at the cube's centre is least, about
  double gauge;           ///< there and then, about
};

SweptPrimitive::SweptPrimitive(const Primitive& primitive, const EnclosedPath& path)
    : path_(path),
      bounds_(primitive.superquadric),
      smallest_semi_axis_(std::ranges::min(primitive.superquadric.semi_axes)),
      gauge_(NormFunction<double>::gauge(primitive.superquadric)) {
  const PosedSuperquadric posed(primitive);
  rotation_ = in_binary64(posed.motion().rotation);
  translation_ = in_binary64(posed.motion().translation);
  radius_ = in_binary64(posed.radius());
}

std::vector<PartOfLeg> SweptPrimitive::whole_path() const {
  std::vector<PartOfLeg> whole;
  for (std::uint32_t leg = 0; leg < path_.legs(); ++leg) whole.push_back({leg, 0.0, 1.0});
  return whole;
}

// The origin moves on a curve with |x''| <= |w|² |R p|: no farther from its chord than an eighth of that.
std::array<Interval, 3> SweptPrimitive::box() const {
  std::array<Interval, 3> box;
  for (std::uint32_t leg = 0; leg < path_.legs(); ++leg) {
    const Interval bow = square(length<double>(path_.motion(leg).spin)) * length<double>(translation_) / Interval(8);
    const double about = (radius_ + bow).upper();
    const Vector3<double> begin = placement(leg, 0.0).origin;
    const Vector3<double> end = placement(leg, 1.0).origin;
    for (std::size_t i = 0; i < 3; ++i) {
      const Interval reached = hull(begin[i], end[i]) + Interval(-about, about);
      box[i] = leg == 0 ? reached : hull(box[i], reached);
    }
  }
  return box;
}

SweptPrimitive::Placement SweptPrimitive::placement(std::uint32_t leg, double time) const {
  const EnclosedPose at = path_.pose(leg, time);
  return {at.rotation * rotation_, at.rotation * translation_ + at.translation};
}

MovingGauge SweptPrimitive::moving_gauge(std::uint32_t leg) const {
  return {gauge_, {rotation_, translation_}, path_.pose(leg, 0.0), path_.motion(leg)};
}

/// Let y = R^T (x - t) be where the implant has a point x of the cube, and v a vector of length 1 of its frame. Then
/// |(v·y)''| <= |w|² |x - t| + 2 |w| |t'|, and v·y lies, between two times, above its chord less an eighth of that and
/// of the square of the time between. Precondition: the leg turns.
double SweptPrimitive::sag(const Cube& cube, const PartOfLeg& times) const {
  const EnclosedMotion& motion = path_.motion(times.leg);
  const Interval spin = length<double>(motion.spin);
  const Interval speed = length<double>(motion.velocity);
  const Interval lasts = Interval(times.end) - Interval(times.begin);
  const Interval distance = length<double>(range_of(cube) - path_.pose(times.leg, times.begin).translation);
  const Interval bend = square(spin) * (distance + speed * lasts) + Interval(2) * spin * speed;
  return (square(lasts) * bend / Interval(8)).upper();
}

/// The plane is that through the support point of v, which moves with the primitive: v·z <= h(v) for all points z of
/// it, and v·z of a point of the cube is linear in that at each time.
SweptPrimitive::Facing SweptPrimitive::facing(const Cube& cube, const PartOfLeg& times) const {
  const MovingGauge moving = moving_gauge(times.leg);
  const Vector3d centre(cube.centre[0], cube.centre[1], cube.centre[2]);
  Facing result{};
  result.time = moving.nearest_time(times.begin, times.end, centre);
  const MovingGauge::Slope slope = moving.slope(result.time, centre);
  result.gauge = slope.value;
  const bool is_between = times.begin < result.time && result.time < times.end;
  const Vector3d own = moving.own_direction(result.time, moving.normal(result.time, is_between, slope, centre));
  const Vector3<double> v = exact_vector({own[0], own[1], own[2]});

  if (path_.motion(times.leg).turns) result.sag = (Interval(sag(cube, times)) * length<double>(v)).upper();
  const Interval below = Interval(bounds_.support_up(v)) + Interval(result.sag);
  for (const double time : {times.begin, times.end}) {
    const Placement at = placement(times.leg, time);
    const Vector3<double> normal = at.rotation * v;
    const Interval at_centre = normal.dot(exact_vector(cube.centre) - at.origin) - below;
    const Vector3<double> step = normal * Interval(cube.half_width);
    CornerHeights heights;
    for (std::size_t k = 0; k < 8; ++k) {
      heights[k] = at_centre;
      for (std::size_t i = 0; i < 3; ++i) heights[k] += (k >> i & 1U) != 0 ? step[i] : -step[i];
    }
    if (time == times.begin) result.heights = heights;
    lower(result.heights, heights);
  }
  return result;
}

/// Parts of legs are halved until what their planes do in between matters little beside the square of the cube.
SweptPrimitive::InCube SweptPrimitive::in(const Cube& cube, std::span<const PartOfLeg> times) const {
  const double allowed = cube.half_width * std::min(1.0, cube.half_width / smallest_semi_axis_) / 8.0;
  InCube result;
  double least = infinity;
  std::vector<PartOfLeg> open(times.rbegin(), times.rend());
  while (!open.empty()) {
    const PartOfLeg part = open.back();
    open.pop_back();
    const Facing found = facing(cube, part);
    if (all_positive(found.heights)) continue;
    const std::optional<double> half = found.sag > allowed ? middle_of(part) : std::nullopt;
    if (half) {
      open.push_back({part.leg, *half, part.end});
      open.push_back({part.leg, part.begin, *half});
      continue;
    }
    if (result.times.empty()) result.outer = found.heights;
    lower(result.outer, found.heights);
    if (result.times.empty() || found.gauge < least) {
      least = found.gauge;
      result.deepest = {part.leg, found.time};
    }
    result.times.push_back(part);
  }
  return result;
}

CornerHeights SweptPrimitive::inner(const Cube& cube, const Moment& moment) const {
  const auto& [leg, time] = moment;
  const double step = path_.step();
  const bool turns = path_.motion(leg).turns;
  const Placement at = placement(leg, turns ? std::clamp(std::round(time / step) * step, 0.0, 1.0) : time);
  const Matrix3<double> to_own = at.rotation.transpose();
  CornerHeights heights;
  for (std::size_t k = 0; k < 8; ++k) {
    const double gauge = bounds_.gauge_up(to_own * (corner_of(cube, k) - at.origin));
    heights[k] = Interval(subtract(gauge, 1.0, Direction::up));
  }
  return heights;
}

/// Nothing where it cannot be halved at a time at which the path is known.
std::optional<double> SweptPrimitive::middle_of(const PartOfLeg& times) const {
  const double middle = std::round((times.begin + times.end) / (2.0 * path_.step())) * path_.step();
  if (!(times.begin < middle && middle < times.end)) return std::nullopt;
  return middle;
}

}  // namespace verisq::verify
