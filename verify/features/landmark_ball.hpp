/// Balls in which landmarks lie, and the cones of the directions between them.
#pragma once

#include <verisq/model.hpp>

#include "verify/numbers/interval.hpp"
#include "verify/numbers/vector.hpp"

namespace verisq::verify {

// T is the type of the ends: double or Real.

/// The exact point. Precondition: finite.
template <class T>
[[nodiscard]] Vector3<T> exact(const Point& x) {
  return {T(x[0]), T(x[1]), T(x[2])};
}

/// All points within `radius` of a centre.
template <class T>
struct LandmarkBall {
  Vector3<T> centre;
  BasicInterval<T> radius;
};

/// The middle of the segments between the points of two balls.
template <class T>
[[nodiscard]] LandmarkBall<T> middle_of(const LandmarkBall<T>& a, const LandmarkBall<T>& b);

/// All vectors within `reach` of a centre: the differences of the points of two balls.
template <class T>
struct VectorBall {
  Vector3<T> centre;
  BasicInterval<T> reach;
};
template <class T>
[[nodiscard]] VectorBall<T> difference(const LandmarkBall<T>& to, const LandmarkBall<T>& from);

/// In radians: no vector of the ball is more than this from its centre's direction, and some are; nothing below pi is
/// proven where the ball holds 0.
template <class T>
[[nodiscard]] BasicInterval<T> tilt(const VectorBall<T>& v);

/// asin of what lies in [0, 1], pi / 2 beyond; the angle whose sine is at most x.
template <class T>
[[nodiscard]] BasicInterval<T> arcsine(const BasicInterval<T>& x);

/// The angle between two vectors, in [0, pi].
template <class T>
[[nodiscard]] BasicInterval<T> angle_between(const Vector3<T>& a, const Vector3<T>& b);

}  // namespace verisq::verify
