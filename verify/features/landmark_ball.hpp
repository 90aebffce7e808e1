/// Balls in which landmarks lie, and the cones of the directions between them.
#pragma once

#include <verisq/model.hpp>

#include "verify/numbers/interval.hpp"
#include "verify/numbers/vector.hpp"

namespace verisq::verify {

using IntervalVector3 = Vector3<double>;

/// All points within `radius` of a centre.
struct LandmarkBall {
  IntervalVector3 centre;
  Interval radius;

  LandmarkBall(const Point& at, double known_to) : centre(at[0], at[1], at[2]), radius(known_to) {}
  LandmarkBall(const IntervalVector3& at, const Interval& known_to) : centre(at), radius(known_to) {}
};

/// The middle of the segments between the points of two balls.
[[nodiscard]] LandmarkBall middle_of(const LandmarkBall& a, const LandmarkBall& b);

/// All vectors within `reach` of a centre: the differences of the points of two balls.
struct VectorBall {
  IntervalVector3 centre;
  Interval reach;
};
[[nodiscard]] VectorBall difference(const LandmarkBall& to, const LandmarkBall& from);

/// In radians: no vector of the ball is more than this from its centre's direction, and some are; nothing below pi is
/// proven where the ball holds 0.
[[nodiscard]] Interval tilt(const VectorBall& v);

/// asin of what lies in [0, 1], pi / 2 beyond; the angle whose sine is at most x.
[[nodiscard]] Interval arcsine(const Interval& x);

/// The angle between two vectors, in [0, pi].
[[nodiscard]] Interval angle_between(const IntervalVector3& a, const IntervalVector3& b);

}  // namespace verisq::verify
