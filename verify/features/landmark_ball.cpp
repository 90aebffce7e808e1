/// See the header: each bound is attained by some choice of the points, but for rounding.
#include "verify/features/landmark_ball.hpp"

#include "verify/analysis/cross_product.hpp"
#include "verify/analysis/trigonometry.hpp"

namespace verisq::verify {

LandmarkBall middle_of(const LandmarkBall& a, const LandmarkBall& b) {
  const Interval half(0.5);
  return {(a.centre + b.centre) * half, (a.radius + b.radius) * half};
}

VectorBall difference(const LandmarkBall& to, const LandmarkBall& from) {
  return {to.centre - from.centre, to.radius + from.radius};
}

Interval arcsine(const Interval& x) {
  const Interval one(1.0);
  if (x.upper() >= 1.0) return pi<double>() * Interval(0.5);
  return atan(x / sqrt((one - x) * (one + x)));
}

Interval tilt(const VectorBall& v) {
  const Interval size = length(v.centre);
  if (v.reach.upper() >= size.lower()) return pi<double>();
  return arcsine(v.reach / size);
}

Interval angle_between(const IntervalVector3& a, const IntervalVector3& b) {
  return polar_angle(a.dot(b), length(cross(a, b)));
}

}  // namespace verisq::verify
