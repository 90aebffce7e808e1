/// Poses composed in precise interval arithmetic, then rounded.
#include "verisq/posed_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "verify/proof/rigid_motion.hpp"
#include "verisq/error.hpp"

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
  Model moved = model;
  for (Primitive& primitive : moved.primitives) primitive.pose = composed(pose, primitive.pose);
  return moved;
}

UncertainModel posed(const UncertainModel& model, const Pose& pose) {
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
  return moved_by(verify::RigidMotion(pose), point);
}

FemurLandmarks posed(const FemurLandmarks& landmarks, const Pose& pose) {
  const verify::RigidMotion motion(pose);
  FemurLandmarks moved = landmarks;
  for (const NamedLandmark& landmark : named_landmarks) {
    std::optional<Point>& point = moved.*landmark.point;
    if (point) point = moved_by(motion, *point);
  }
  return moved;
}

}  // namespace verisq
