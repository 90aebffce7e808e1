/// See the header: each bound is attained by some choice of the points, but for rounding.
#include "verify/features/landmark_ball.hpp"

#include "verify/analysis/cross_product.hpp"
#include "verify/analysis/trigonometry.hpp"

namespace verisq::verify {

template <class T>
LandmarkBall<T> middle_of(const LandmarkBall<T>& a, const LandmarkBall<T>& b) {
  const BasicInterval<T> half(T(0.5));
  return {(a.centre + b.centre) * half, (a.radius + b.radius) * half};
}

template <class T>
VectorBall<T> difference(const LandmarkBall<T>& to, const LandmarkBall<T>& from) {
  return {to.centre - from.centre, to.radius + from.radius};
}

template <class T>
BasicInterval<T> arcsine(const BasicInterval<T>& x) {
  const BasicInterval<T> one(1);
  if (x.upper() >= T(1)) return pi<T>() / BasicInterval<T>(2);
  return atan(x / sqrt((one - x) * (one + x)));
}

template <class T>
BasicInterval<T> tilt(const VectorBall<T>& v) {
  const BasicInterval<T> size = length(v.centre);
  if (v.reach.upper() >= size.lower()) return pi<T>();
  return arcsine(v.reach / size);
}

template <class T>
BasicInterval<T> angle_between(const Vector3<T>& a, const Vector3<T>& b) {
  return polar_angle(a.dot(b), length(cross(a, b)));
}

template LandmarkBall<double> middle_of(const LandmarkBall<double>&, const LandmarkBall<double>&);
template VectorBall<double> difference(const LandmarkBall<double>&, const LandmarkBall<double>&);
template BasicInterval<double> arcsine(const BasicInterval<double>&);
template BasicInterval<double> tilt(const VectorBall<double>&);
template BasicInterval<double> angle_between(const Vector3<double>&, const Vector3<double>&);
template LandmarkBall<Real> middle_of(const LandmarkBall<Real>&, const LandmarkBall<Real>&);
template VectorBall<Real> difference(const LandmarkBall<Real>&, const LandmarkBall<Real>&);
template BasicInterval<Real> arcsine(const BasicInterval<Real>&);
template BasicInterval<Real> tilt(const VectorBall<Real>&);
template BasicInterval<Real> angle_between(const Vector3<Real>&, const Vector3<Real>&);

}  // namespace verisq::verify
