/// The gauge G of the moving primitive, as a function of the place and the time, is least at some time. A plane that
/// touches the primitive there proposes the plane of the swept set. One evaluation for it and eight for the cube's
/// corners prove both half-spaces.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "verify/numbers/functions.hpp"
#include "verify/numbers/vector.hpp"
#include "verify/proof/posed_superquadric.hpp"
#include "verify/search/clipped_cube.hpp"

namespace verisq::verify {
namespace {

using Eigen::Vector3d;

Point point_of(const Vector3d& x) {
  return {x[0], x[1], x[2]};
}

/// {x : |x_i - centre_i| <= half_width}
Vector3<double> box_of(const Cube& cube) {
  const Interval about(-cube.half_width, cube.half_width);
  return exact_vector(cube.centre) + Vector3<double>(about, about, about);
}

bool is_usable(const Vector3d& v) {
  return v.allFinite() && v.norm() > 0.0;
}

constexpr std::array<Point, 8> corners_of_cube{
    {{-1, -1, -1}, {1, -1, -1}, {-1, 1, -1}, {1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {-1, 1, 1}, {1, 1, 1}}};

/// Returns whether {e : normal·e <= offset} contains all of a cube; then whether it contains nothing of it.
bool holds_all(const CuttingPlane& plane, double half_width) {
  return plane.offset >= reach_up(plane.normal, half_width);
}
bool holds_nothing(const CuttingPlane& plane, double half_width) {
  return plane.offset < -reach_up(plane.normal, half_width);
}

}  // namespace

/// The primitive at one time: from its own frame to that of the bone.
struct MovingPrimitive::Placement {
  EnclosedPose path;
  Matrix3<double> rotation;
  Vector3<double> origin;
};

/// A half-space that contains the part of a cube swept during a stretch, and the data from which it is computed.
struct MovingPrimitive::Plane {
  CuttingPlane outer;
  TimeStretch stretch;
  double slack;    ///< slack of its offset: for the motion during the stretch
  double gauge;    ///< at the cube's centre, about
  Vector3d slope;  ///< gradient of the gauge there, about
  Placement at;
};

MovingPrimitive::MovingPrimitive(const Primitive& primitive, const EnclosedPath& path)
    : path_(path),
      bounds_(primitive.superquadric),
      gauge_(NormFunction<double>::gauge(primitive.superquadric)),
      smallest_semi_axis_(std::ranges::min(primitive.superquadric.semi_axes)) {
  const PosedSuperquadric posed(primitive);
  rotation_ = in_binary64(posed.motion().rotation);
  translation_ = in_binary64(posed.motion().translation);
}

std::vector<TimeStretch> MovingPrimitive::whole_path() const {
  std::vector<TimeStretch> whole;
  for (std::uint32_t leg = 0; leg < path_.legs(); ++leg) whole.push_back({leg, 0.0, 1.0});
  return whole;
}

// The origin moves on a curve with |x''| <= |w|² |R p|: no farther from its chord than an eighth of that.
std::array<Interval, 3> MovingPrimitive::box() const {
  Vector3<double> own;
  for (std::size_t i = 0; i < 3; ++i) {
    Vector3<double> axis;
    axis[i] = Interval(1);
    own[i] = Interval(-bounds_.support_up(-axis), bounds_.support_up(axis));
  }
  const double radius = length<double>(own).upper();
  std::array<Interval, 3> box;
  for (std::size_t leg = 0; leg < path_.legs(); ++leg) {
    const Interval bow = square(length<double>(path_.motion(leg).spin)) * length<double>(translation_) / Interval(8);
    const Interval about = Interval(radius) + bow;
    const Placement begin = placement(leg, 0.0);
    const Placement end = placement(leg, 1.0);
    for (std::size_t i = 0; i < 3; ++i) {
      const Interval reached = hull(begin.origin[i], end.origin[i]) + Interval(-about.upper(), about.upper());
      box[i] = leg == 0 ? reached : hull(box[i], reached);
    }
  }
  return box;
}

MovingPrimitive::Placement MovingPrimitive::placement(std::size_t leg, double time) const {
  Placement at{path_.pose(leg, time), {}, {}};
  at.rotation = at.path.rotation * rotation_;
  at.origin = at.path.rotation * translation_ + at.path.translation;
  return at;
}

MovingGauge MovingPrimitive::moving_gauge(std::size_t leg) const {
  return {gauge_, {rotation_, translation_}, path_.pose(leg, 0.0), path_.motion(leg)};
}

/// Let v be a vector fixed in the implant's frame that is n at the time s, and phi(t) = v·y(t) for y(t) = R^T(x - t)
/// (docs/mathematics.md §23): phi(t) >= phi(s) - max((t - s) -phi'(s)) - (t - s)² |n| |y''| / 2.
MovingPrimitive::Plane MovingPrimitive::plane(const Cube& cube, const TimeStretch& stretch) const {
  const EnclosedMotion& motion = path_.motion(stretch.leg);
  const MovingGauge gauge = moving_gauge(stretch.leg);
  const Vector3d centre(cube.centre[0], cube.centre[1], cube.centre[2]);
  double time = gauge.nearest_time(stretch.begin, stretch.end, centre);
  const bool is_between = stretch.begin < time && time < stretch.end;
  if (motion.turns) time = std::clamp(std::round(time / path_.step()) * path_.step(), stretch.begin, stretch.end);
  const MovingGauge::Slope slope = gauge.slope(time, centre);
  const Vector3d normal = gauge.normal(time, is_between, slope, centre);

  Plane result{{point_of(normal), 0.0}, stretch, 0.0, slope.value, slope.gradient, placement(stretch.leg, time)};
  const Placement& at = result.at;
  const Vector3<double> n = exact_vector(result.outer.normal);
  const Vector3<double> way = box_of(cube) - at.path.translation;  // of all points of the cube
  const Interval derivative = -(cross(n, motion.spin).dot(way) + n.dot(motion.velocity));
  const Interval until_end = Interval(stretch.end) - Interval(time);
  const Interval since_begin = Interval(time) - Interval(stretch.begin);
  const double linear = std::max({0.0, (until_end * -derivative).upper(), (since_begin * derivative).upper()});
  Interval quadratic(0);
  if (motion.turns) {
    const Interval spin = length<double>(motion.spin);
    const Interval speed = length<double>(motion.velocity);
    const Interval longest(std::max(until_end.upper(), since_begin.upper()));
    const Interval distance = length<double>(way) + speed * longest;
    const Interval bend = square(spin) * distance + Interval(2) * spin * speed;
    quadratic = square(longest) * length<double>(n) * bend / Interval(2);
  }
  const Interval slack = Interval(linear) + Interval(quadratic.upper());
  const Interval support(bounds_.support_up(at.rotation.transpose() * n));
  result.slack = slack.upper();
  result.outer.offset = (support + n.dot(at.origin - exact_vector(cube.centre)) + slack).upper();
  return result;
}

/// G is convex in x: G - slope·e is largest at a corner, say m. If slope·e <= 1 - m, G <= 1.
CuttingPlane MovingPrimitive::inner_plane(const Cube& cube, const Plane& plane) const {
  const Point slope = is_usable(plane.slope) ? point_of(plane.slope) : Point{1.0, 0.0, 0.0};
  const Matrix3<double> to_own = plane.at.rotation.transpose();
  double largest = -infinity;
  for (const Point& corner : corners_of_cube) {
    Vector3<double> e;
    for (std::size_t i = 0; i < 3; ++i) e[i] = Interval(corner[i] * cube.half_width);  // exact
    const Vector3<double> own = to_own * (exact_vector(cube.centre) + e - plane.at.origin);
    largest = std::max(largest, (Interval(bounds_.gauge_up(own)) - exact_vector(slope).dot(e)).upper());
  }
  return {slope, subtract(1.0, largest, Direction::down)};
}

/// Half-spaces {n_j·e <= b_j} of stretches, brought to the normal n of one of them: their parts of the cube lie in {n·e
/// <= b_j + h |n - n_j|_1}.
double MovingPrimitive::offset_along(const Plane& plane, const Plane& other, double half_width) {
  const Vector3<double> turned = exact_vector(plane.outer.normal) - exact_vector(other.outer.normal);
  Interval apart(0);
  for (std::size_t i = 0; i < 3; ++i) apart += abs(turned[i]) * Interval(half_width);
  return (Interval(other.outer.offset) + apart).upper();
}

/// Removes planes whose half-spaces contain nothing of the cube, and stretches whose slack decides. Returns the halves
/// of the latter.
std::vector<TimeStretch> MovingPrimitive::halved(std::vector<Plane>& planes, const Plane& deepest,
                                                 const Cube& cube) const {
  const double half_width = cube.half_width;
  const double allowed = half_width * std::min(1.0, half_width / smallest_semi_axis_) / 8.0;
  const double least = deepest.outer.offset - deepest.slack;  // about: no better half-space is to be had
  const double reach = reach_up(deepest.outer.normal, half_width);
  std::vector<TimeStretch> halves;
  if (!(least < reach)) return halves;
  std::erase_if(planes, [&](const Plane& other) {
    const double offset = offset_along(deepest, other, half_width);
    if (offset < -reach) return true;  // it holds nothing of the cube
    if (offset <= least + allowed || other.slack <= allowed || !is_divisible(other.stretch)) return false;
    const double middle = middle_of(other.stretch);
    halves.push_back({other.stretch.leg, other.stretch.begin, middle});
    halves.push_back({other.stretch.leg, middle, other.stretch.end});
    return true;
  });
  return halves;
}

SweptPart MovingPrimitive::part(const Cube& cube, std::span<const TimeStretch> stretches) const {
  const double half_width = cube.half_width;
  SweptPart result;
  std::vector<Plane> planes;
  const auto add = [&](const TimeStretch& stretch) {
    Plane found = plane(cube, stretch);
    if (!holds_nothing(found.outer, half_width)) planes.push_back(std::move(found));
  };
  for (const TimeStretch& stretch : stretches) add(stretch);
  while (!planes.empty()) {
    const Plane deepest = *std::ranges::min_element(planes, {}, &Plane::gauge);
    const CuttingPlane inner = inner_plane(cube, deepest);
    result.covered = std::isfinite(inner.offset) && holds_all(inner, half_width);
    result.inner.reset();
    if (std::isfinite(inner.offset) && !holds_nothing(inner, half_width)) result.inner = inner;

    const std::vector<TimeStretch> halves = result.covered ? std::vector<TimeStretch>() : halved(planes, deepest, cube);
    if (halves.empty()) break;
    for (const TimeStretch& half : halves) add(half);
  }
  if (planes.empty()) return {};

  const Plane& deepest = *std::ranges::min_element(planes, {}, &Plane::gauge);
  CuttingPlane outer = deepest.outer;
  for (const Plane& other : planes) {
    result.open.push_back(other.stretch);
    outer.offset = std::max(outer.offset, offset_along(deepest, other, half_width));
  }
  if (std::isfinite(outer.offset) && !holds_all(outer, half_width)) result.outer = outer;
  return result;
}

double MovingPrimitive::middle_of(const TimeStretch& stretch) const {
  return std::round((stretch.begin + stretch.end) / (2.0 * path_.step())) * path_.step();
}

bool MovingPrimitive::is_divisible(const TimeStretch& stretch) const {
  const double middle = middle_of(stretch);
  return path_.motion(stretch.leg).turns && stretch.begin < middle && middle < stretch.end;
}

}  // namespace verisq::verify
