/// This file implements paths.hpp.
#include "verify/solids/paths.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "verify/numbers/functions.hpp"
#include "verify/numbers/points.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/numbers/vector.hpp"
#include "verify/solids/model.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/error.hpp"

namespace verisq::verify {

ShortMotion::ShortMotion(const RigidMotion& pose, const SteadyMotion& motion, double reach)
    : pose_(pose), motion_(motion), time_(Real(reach)), rate_(length<Real>(motion.spin)), rests_(reach == 0.0) {}

// A point at x, from the origin, has the acceleration w x (w x x), at most |w| |w x x|; the turn keeps |w x x|. A point
// no farther than r from a centre has at most |w| (|w x centre| + |w| r).
PreciseInterval ShortMotion::bend_of_ways(const EnclosingSphere& sphere) const {
  const PreciseVector from_origin = sphere.centre - pose_.translation;
  const PreciseInterval across = length<Real>(PreciseVector(cross(motion_.spin, from_origin)));
  return PreciseInterval(Real(0.5)) * square(time_) * rate_ * (across + rate_ * sphere.radius);
}

PreciseInterval ShortMotion::way_at_first_speed(const EnclosingSphere& sphere) const {
  return length<Real>(first_way_of(sphere.centre)) + time_ * rate_ * sphere.radius;
}

// At all times the points of the sphere are faster than its centre by at most |w| r: only the centre's acceleration
// counts.
PreciseInterval ShortMotion::way_of(const EnclosingSphere& sphere) const {
  if (rests_) return PreciseInterval(0);
  return way_at_first_speed(sphere) + bend_of_ways({sphere.centre, PreciseInterval(0)});
}

// A point that rests at x has the speed |w x (x - t) + v|, too. Its velocity changes by w x v, because t changes by v.
PreciseInterval ShortMotion::way_seen_of(const EnclosingSphere& sphere) const {
  if (rests_) return PreciseInterval(0);
  const PreciseInterval change = length<Real>(cross(motion_.spin, motion_.velocity));
  return way_at_first_speed(sphere) + PreciseInterval(Real(0.5)) * square(time_) * change;
}

}  // namespace verisq::verify

namespace verisq {
namespace {

using verify::PreciseInterval;
using verify::PreciseVector;
using verify::Real;
using Quaternion = std::array<PreciseInterval, 4>;

/// Either end serves: they differ by a few units of the 127th bit of the operands.
double nearest(const PreciseInterval& value) {
  return mpfr_get_d(value.lower().get(), MPFR_RNDN);
}

Quaternion exact(const std::array<double, 4>& q) {
  return {Real(q[0]), Real(q[1]), Real(q[2]), Real(q[3])};
}

/// The rotation by b, then by a (Hamilton's product).
Quaternion product(const Quaternion& a, const Quaternion& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

std::array<double, 4> normalised(const Quaternion& q) {
  const PreciseInterval length = sqrt(square(q[0]) + square(q[1]) + square(q[2]) + square(q[3]));
  return {nearest(q[0] / length), nearest(q[1] / length), nearest(q[2] / length), nearest(q[3] / length)};
}

Point moved_by(const verify::RigidMotion& motion, const Point& point) {
  const PreciseVector moved = motion(verify::precise(point));
  return {nearest(moved[0]), nearest(moved[1]), nearest(moved[2])};
}

/// x -> outer(inner(x))
Pose composed(const Pose& outer, const Pose& inner) {
  const Pose result{.translation = moved_by(verify::RigidMotion(outer), inner.translation),
                    .quaternion = normalised(product(exact(outer.quaternion), exact(inner.quaternion)))};
  if (!std::ranges::all_of(result.translation, [](double x) { return std::isfinite(x); }))
    throw Error(ErrorKind::input, "the pose moves the model beyond what binary64 holds");
  return result;
}

}  // namespace

Model posed(const Model& model, const Pose& pose) {
  verify::require_valid_with_meshes(model);
  verify::require_valid(pose, "pose");
  Model moved = model;
  for (Primitive& primitive : moved.primitives) primitive.pose = composed(pose, primitive.pose);
  return moved;
}

UncertainModel posed(const UncertainModel& model, const Pose& pose) {
  verify::require_valid_with_meshes(model);
  verify::require_valid(pose, "pose");
  UncertainModel moved = model;
  for (UncertainPrimitive& primitive : moved.primitives) {
    Pose inner{.quaternion = primitive.quaternion};
    for (std::size_t i = 0; i < inner.translation.size(); ++i) {
      const Enclosure& coordinate = primitive.translation[i];
      if (coordinate.lo != coordinate.hi) {
        throw Error(ErrorKind::input, "translations that are intervals cannot be moved by a pose");
      }
      inner.translation[i] = coordinate.lo;
    }
    const Pose outer = composed(pose, inner);
    primitive.quaternion = outer.quaternion;
    for (std::size_t i = 0; i < inner.translation.size(); ++i) {
      primitive.translation[i] = {outer.translation[i], outer.translation[i]};
    }
  }
  return moved;
}

Point posed(const Point& point, const Pose& pose) {
  verify::require_finite(point, "point");
  verify::require_valid(pose, "pose");
  return moved_by(verify::RigidMotion(pose), point);
}

FemurLandmarks posed(const FemurLandmarks& landmarks, const Pose& pose) {
  verify::require_valid(pose, "pose");
  const verify::RigidMotion motion(pose);
  FemurLandmarks moved = landmarks;
  for (const NamedLandmark& landmark : named_landmarks) {
    std::optional<Point>& point = moved.*landmark.point;
    if (point) point = moved_by(motion, *point);
  }
  return moved;
}

}  // namespace verisq

namespace verisq::verify {
namespace {

using Quaternion = std::array<PreciseInterval, 4>;

constexpr double smallest_normal = std::numeric_limits<double>::min();

double nearest(const PreciseInterval& a) {
  return mpfr_get_d(a.lower().get(), MPFR_RNDN);
}

double upper(const PreciseInterval& a) {
  return a.upper().to_double(Direction::up);
}

double one_norm(const Point& x) {
  return std::abs(x[0]) + std::abs(x[1]) + std::abs(x[2]);
}

/// The sign of the exact product of two quaternions as vectors: decides which way round is the shorter one.
int sign_of_product(const std::array<double, 4>& a, const std::array<double, 4>& b) {
  constexpr mpfr_prec_t exact = 2L * DBL_MANT_DIG;
  std::array<MpfrNumber<exact>, 4> products;
  std::array<mpfr_ptr, 4> terms{};
  for (std::size_t i = 0; i < 4; ++i) {
    products[i] =
        rounded_result<exact>(mpfr_mul, Direction::down, MpfrNumber<exact>(a[i]).get(), MpfrNumber<exact>(b[i]).get());
    terms[i] = products[i].get();
  }
  Real sum;
  mpfr_sum(sum.get(), terms.data(), terms.size(), MPFR_RNDN);  // correctly rounded: has the sign of the exact sum
  return mpfr_sgn(sum.get());
}

Quaternion unit(const Quaternion& q) {
  const PreciseInterval length = sqrt(square(q[0]) + square(q[1]) + square(q[2]) + square(q[3]));
  return {q[0] / length, q[1] / length, q[2] / length, q[3] / length};
}

Quaternion unit(const std::array<double, 4>& q) {
  return unit(Quaternion{Real(q[0]), Real(q[1]), Real(q[2]), Real(q[3])});
}

Quaternion sum(const Quaternion& p, const Quaternion& q) {
  return {p[0] + q[0], p[1] + q[1], p[2] + q[2], p[3] + q[3]};
}

/// The normalised sum of two unit quaternions is the rotation half-way between them: halving is as exact as a root,
/// and reaches every time that is a binary fraction.
Quaternion between(Quaternion from, Quaternion to, double fraction) {
  while (fraction != 0.0 && fraction != 1.0) {
    const Quaternion middle = unit(sum(from, to));
    if (fraction < 0.5) {
      to = middle;
      fraction = 2.0 * fraction;
    } else {
      from = middle;
      fraction = 2.0 * fraction - 1.0;  // exact
    }
  }
  return fraction == 0.0 ? from : to;
}

/// The rotation matrix of a unit quaternion.
PreciseMatrix rotation_of(const Quaternion& q) {
  const PreciseInterval one(1);
  const PreciseInterval two(2);
  const auto& w = q[0];
  const auto& x = q[1];
  const auto& y = q[2];
  const auto& z = q[3];
  const auto square_entry = [&](const PreciseInterval& a, const PreciseInterval& b) {
    return one - two * (square(a) + square(b));
  };
  const auto sum_entry = [&](const PreciseInterval& product, const PreciseInterval& other) {
    return two * (product + other);
  };
  return {{square_entry(y, z), sum_entry(x * y, -(w * z)), sum_entry(x * z, w * y)},
          {sum_entry(x * y, w * z), square_entry(x, z), sum_entry(y * z, -(w * x))},
          {sum_entry(x * z, -(w * y)), sum_entry(y * z, w * x), square_entry(x, y)}};
}

/// Halvings widen the enclosures, with all the digits that a time has to some 2^-90. A wider enclosure does not
/// determine the number to nearest.
bool is_narrow(const PreciseMatrix& rotation) {
  const Real widest(0x1p-60);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      const PreciseInterval& entry = rotation(i, j);
      if (!(subtract(entry.upper(), entry.lower(), Direction::up) <= widest)) return false;
    }
  }
  return true;
}

Point to_nearest(const PreciseVector& v) {
  return {nearest(v[0]), nearest(v[1]), nearest(v[2])};
}

/// A pose, enclosed; of a unit quaternion.
struct Placement {
  Quaternion rotation;
  PreciseVector translation;
};

Placement placement_at(std::span<const Pose> poses, double time) {
  const auto k = static_cast<std::size_t>(time);
  const double fraction = time - static_cast<double>(k);  // exact
  const PreciseVector start = precise(poses[k].translation);
  const Quaternion from = unit(poses[k].quaternion);
  if (fraction == 0.0) return {from, start};
  const PreciseVector velocity = precise(poses[k + 1].translation) - start;
  return {between(from, unit(poses[k + 1].quaternion), fraction), start + velocity * PreciseInterval(Real(fraction))};
}

/// The rotation vector of to from^-1. Precondition: the shorter way round, the scalar part is not negative.
PreciseVector rotation_vector(const Quaternion& from, const Quaternion& to) {
  const PreciseVector a(from[1], from[2], from[3]);
  const PreciseVector b(to[1], to[2], to[3]);
  const PreciseInterval scalar = from[0] * to[0] + a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const PreciseVector vector = b * from[0] - a * to[0] + cross(a, b);  // from q_to conj(q_from): b a^-1
  const PreciseInterval sine = length<Real>(vector);
  const PreciseInterval two(2);
  // Half the angle is atan(sine / scalar). Below a quarter of a turn no division by a number that may be 0 occurs.
  if (scalar.lower() > Real(0.5)) {
    return vector * (two * arctangent_quotient(PreciseInterval(sine / scalar)) / scalar);
  }
  return vector * (two * polar_angle(scalar, sine) / sine);
}

}  // namespace

RigidPath::RigidPath(std::span<const Pose> poses, const Point& about)
    : poses_(poses.begin(), poses.end()), about_(about), travelled_{{}} {
  for (std::size_t k = 1; k < poses_.size(); ++k) {
    auto& quaternion = poses_[k].quaternion;
    if (sign_of_product(poses_[k - 1].quaternion, quaternion) < 0) {
      for (double& element : quaternion) element = -element;
    }
    legs_.push_back(leg(poses_[k - 1], poses_[k]));
    travelled_.push_back(travelled_further(travelled_.back(), legs_.back()));
  }
}

RigidPath::Leg RigidPath::leg(const Pose& from, const Pose& to) {
  const PreciseVector spin = rotation_vector(unit(from.quaternion), unit(to.quaternion));
  Leg leg{.start = from.translation,
          .velocity = {},
          .spin = {},
          .spin_error = 0.0,
          .reach = one_norm(from.translation) + one_norm(to.translation)};
  for (std::size_t i = 0; i < 3; ++i) {
    leg.velocity[i] = to.translation[i] - from.translation[i];
    leg.spin[i] = nearest(spin[i]);
    leg.spin_error = add(leg.spin_error, upper(abs(spin[i] - PreciseInterval(Real(leg.spin[i])))), Direction::up);
  }
  return leg;
}

Vector3<double> RigidPath::spin(std::size_t k) const {
  const Leg& leg = legs_[k];
  Vector3<double> spin;
  for (std::size_t i = 0; i < 3; ++i) spin[i] = Interval(leg.spin[i]) + Interval(-leg.spin_error, leg.spin_error);
  return spin;
}

RigidMotion RigidPath::enclosed_pose(double time) const {
  const auto [rotation, translation] = placement_at(poses_, time);
  return {rotation_of(rotation), translation};
}

Pose RigidPath::rounded_pose(double time) const {
  const auto k = static_cast<std::size_t>(time);
  if (time == static_cast<double>(k)) return poses_[k];
  const auto [rotation, translation] = placement_at(poses_, time);
  return {to_nearest(translation),
          {nearest(rotation[0]), nearest(rotation[1]), nearest(rotation[2]), nearest(rotation[3])}};
}

RigidPath::NearestPose RigidPath::nearest_pose(double time) const {
  const auto k = static_cast<std::size_t>(time);
  const RigidMotion pose = enclosed_pose(time);
  const bool moves = time != static_cast<double>(k);
  const double of_ends = moves ? one_norm(poses_[k].translation) + one_norm(poses_[k + 1].translation) : 0.0;
  const PreciseMatrix& rotation = pose.rotation;
  return {.rotation = {to_nearest(rotation.row(0)), to_nearest(rotation.row(1)), to_nearest(rotation.row(2))},
          .translation = to_nearest(pose.translation),
          .reach = is_narrow(rotation) ? of_ends : infinity};
}

// With u = 2^-53, S = |c|_1 + |t|_1 and rounded numbers marked by ~: each |t~_i - t_i| <= u |t_i| (and hardly more: the
// enclosures are 2^-120 wide). Each |R~_ij - R_ij| <= u because |R_ij| <= 1 and its enclosure is at most 2^-60 wide;
// else nothing is known. |c_i - t~_i| is rounded by u of itself. A product and its two additions round by at most 3.01
// u |R~_ij| |d~_i|. In all each coordinate errs by at most u (|t|_1 + 1.01 S) + 1.01 u S + 3.05 u S < 8 u S, the vector
// by less than 16 u S = 2^-49 S. This is doubled to cover the rounding of S itself; underflow costs less than the
// smallest normal number. If the ends of a leg cancel in t, the rounding of their 127 bits, less than 2^-110 of them,
// is no longer small beside |t|: it is added.
PointBall RigidPath::local_point(const NearestPose& pose, const Point& c) {
  const auto& [rotation, t, reach] = pose;
  const Point d{c[0] - t[0], c[1] - t[1], c[2] - t[2]};
  PointBall ball{{}, 0x1p-48 * (one_norm(c) + one_norm(t)) + 0x1p-100 * reach + smallest_normal};
  for (std::size_t j = 0; j < 3; ++j) {
    ball.centre[j] = rotation[0][j] * d[0] + rotation[1][j] * d[1] + rotation[2][j] * d[2];
  }
  return ball;
}

// As above: with reach r = |c|_1 + |t_begin|_1 + |t_end|_1, c - t(s) errs by at most 5 u r in all coordinates together.
// A coordinate of its product with the spin errs by 8.1 u |w|_1 r, a coordinate of the sum with the velocity by 3 u
// |v|_1 more. The vector errs by less than 16 u (|w|_1 r + |v|_1), and by spin_error r. The code adds twice that and
// more; the factor 1 + 2^-49 covers the rounding of the length (points.hpp).
double RigidPath::speed_up(const Leg& leg, const Point& c, double time) {
  const auto& [start, v, w, spin_error, way_reach] = leg;
  Point d;
  for (std::size_t i = 0; i < 3; ++i) d[i] = c[i] - start[i] - time * v[i];
  const double x = w[1] * d[2] - w[2] * d[1] + v[0];
  const double y = w[2] * d[0] - w[0] * d[2] + v[1];
  const double z = w[0] * d[1] - w[1] * d[0] + v[2];
  const double reach = one_norm(c) + way_reach;
  const double error = 0x1p-47 * (one_norm(w) * reach + one_norm(v)) + 4.0 * spin_error * reach + smallest_normal;
  const double speed = length(x, y, z) * (1.0 + 0x1p-49) + error;
  return speed < infinity ? speed : infinity;  // also for NaN
}

// Sums from above and from below lose a rounding in each leg; their difference bounds the travel between two legs.
RigidPath::Travelled RigidPath::travelled_further(const Travelled& before, const Leg& leg) const {
  const double way = std::max(speed_up(leg, about_, 0.0), speed_up(leg, about_, 1.0));
  const auto& w = leg.spin;
  const double angle = add(length(w[0], w[1], w[2]) * (1.0 + 0x1p-48), leg.spin_error, Direction::up) + smallest_normal;
  const auto sum = [](const Enclosure& so_far, double next) {
    return Enclosure{add(so_far.lo, next, Direction::down), add(so_far.hi, next, Direction::up)};
  };
  return {sum(before.way, way), sum(before.angle, angle)};
}

// The speed of c differs from the speed of `about` by at most |w x (c - about)|. So on whole legs c travels no farther
// than the bound of `about` plus the angle times |c - about|. For points near the path's own point a bound leg by leg
// is tighter.
double RigidPath::length_of_legs_up(const Point& c, double begin, double end) const {
  const Travelled& from = travelled_[static_cast<std::size_t>(begin)];
  const Travelled& to = travelled_[static_cast<std::size_t>(end)];
  const auto between = [](const Enclosure& first, const Enclosure& last) {
    return subtract(last.hi, first.lo, Direction::up);
  };
  const double apart = length(c[0] - about_[0], c[1] - about_[1], c[2] - about_[2]) * (1.0 + 0x1p-48) +
                       0x1p-50 * (one_norm(c) + one_norm(about_)) + smallest_normal;
  const double turned = multiply(between(from.angle, to.angle), apart, Direction::up);
  const double bound = add(between(from.way, to.way), turned, Direction::up);
  return bound < infinity ? bound : infinity;  // also for NaN
}

double RigidPath::length_up(const Point& c, double begin, double end) const {
  constexpr double few = 16.0;  // legs, which are worth a look at each
  const double first = std::ceil(begin);
  const double last = std::floor(end);
  if (!(last - first > few)) return length_leg_by_leg_up(c, begin, end);
  const double ends = add(length_leg_by_leg_up(c, begin, first), length_leg_by_leg_up(c, last, end), Direction::up);
  return add(ends, length_of_legs_up(c, first, last), Direction::up);
}

double RigidPath::length_leg_by_leg_up(const Point& c, double begin, double end) const {
  double length = 0.0;
  for (double time = begin; time < end;) {
    const double pose_before = std::floor(time);
    const double until = std::min(end, pose_before + 1.0);
    const Leg& leg = legs_[static_cast<std::size_t>(pose_before)];
    const double speed = std::max(speed_up(leg, c, time - pose_before), speed_up(leg, c, until - pose_before));
    const double duration = subtract(until, time, Direction::up);  // of times of any number of digits
    length = add(length, multiply(duration, speed, Direction::up), Direction::up);
    time = until;
  }
  return length;
}

namespace {

/// The number of poses for all legs together: enough to follow a turn, few enough to keep.
constexpr double most_poses = 0x1p14;
constexpr double finest_step = 0x1p-10;
constexpr double coarsest_step = 0x1p-2;

double step_for(std::size_t legs) {
  const double least = static_cast<double>(legs) / most_poses;
  double step = finest_step;
  while (step < std::min(least, coarsest_step)) step *= 2.0;
  return step;
}

Interval about(double x, double radius) {
  return Interval(x) + Interval(-radius, radius);
}

/// An entry of a rotation is at most 1, so rounding to nearest is off by at most 2^-53. A coordinate of the translation
/// is off by 2^-53 of itself and 2^-100 of the sum `reach` of its terms.
EnclosedPose enclosed(const RigidPath::NearestPose& pose) {
  constexpr double error = 0x1p-52;
  EnclosedPose result;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) result.rotation(i, j) = about(pose.rotation[i][j], error);
    const double t = pose.translation[i];
    result.translation[i] = about(t, error * std::abs(t) + 0x1p-99 * pose.reach + std::numeric_limits<double>::min());
  }
  return result;
}

}  // namespace

EnclosedPath::EnclosedPath(std::span<const Pose> poses) : path_(poses), step_(step_for(poses.size())) {
  for (std::size_t k = 0; k + 1 < poses.size(); ++k) {
    EnclosedMotion& motion = motions_.emplace_back();
    motion.turns = poses[k].quaternion != poses[k + 1].quaternion;
    for (std::size_t i = 0; i < 3; ++i) {
      motion.velocity[i] = Interval(poses[k + 1].translation[i]) - Interval(poses[k].translation[i]);
    }
    if (motion.turns) motion.spin = path_.spin(k);
  }
  if (motions_.empty()) motions_.push_back({{}, {}, false});
}

EnclosedPose EnclosedPath::pose(std::size_t leg, double time) const {
  const auto start = static_cast<double>(leg);
  const bool turns = motions_[leg].turns;
  const double asked = turns ? start + time : start;  // exact: a multiple of the step
  EnclosedPose pose = [&] {
    const std::lock_guard lock(mutex_);
    const auto known = poses_.find(asked);
    if (known != poses_.end()) return known->second;
    return poses_.emplace(asked, enclosed(path_.nearest_pose(asked))).first->second;
  }();
  if (!turns) pose.translation = pose.translation + motions_[leg].velocity * Interval(time);
  return pose;
}

ShortMotion PosedPath::motion_between(double begin, double until) const {
  const double middle = std::clamp(0.5 * (begin + until), begin, until);
  const double reach = std::max(subtract(middle, begin, Direction::up), subtract(until, middle, Direction::up));
  return {enclosed_pose(middle), motion_of(static_cast<std::size_t>(begin)), reach};
}

SteadyMotion PosedPath::motion_of(std::size_t leg) const {
  if (leg + 1 >= poses_.size()) return {};  // nothing moves at the last pose alone
  const Vector3<double> spin = path_.spin(leg);
  const auto exact = [](const Interval& x) { return PreciseInterval(Real(x.lower()), Real(x.upper())); };
  return {precise(poses_[leg + 1].translation) - precise(poses_[leg].translation),
          {exact(spin[0]), exact(spin[1]), exact(spin[2])}};
}

}  // namespace verisq::verify
