/// Along a straight leg the gauge at a point is a convex function of time. The search brings a time where the gauge
/// falls and a time where it rises together.
#include "verify/solids/moving_gauge.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace verisq::verify {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

double nearest(const Interval& x) {
  return 0.5 * x.lower() + 0.5 * x.upper();
}

Vector3d nearest(const Vector3<double>& x) {
  return {nearest(x[0]), nearest(x[1]), nearest(x[2])};
}

Matrix3d nearest(const Matrix3<double>& m) {
  Matrix3d result;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) result(i, j) = nearest(m(static_cast<std::size_t>(i), static_cast<std::size_t>(j)));
  return result;
}

/// The rotation by a vector's length about it.
Matrix3d turn(const Vector3d& by) {
  const double angle = by.norm();
  if (!(angle > 0.0)) return Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, by / angle).toRotationMatrix();
}

}  // namespace

MovingGauge::MovingGauge(const NormFunction<double>& gauge, const EnclosedPose& own, const EnclosedPose& at_begin,
                         const EnclosedMotion& motion)
    : gauge_(&gauge),
      own_rotation_(nearest(own.rotation)),
      own_translation_(nearest(own.translation)),
      path_rotation_(nearest(at_begin.rotation)),
      path_translation_(nearest(at_begin.translation)),
      velocity_(nearest(motion.velocity)),
      spin_(nearest(motion.spin)) {}

/// The velocity, at x, of a point that is fixed in the implant's frame.
Vector3d MovingGauge::speed(double time, const Vector3d& x) const {
  return spin_.cross(x - path_translation_ - time * velocity_) + velocity_;
}

/// x in the primitive's own frame, and the rotation from that frame.
std::pair<Vector3d, Matrix3d> MovingGauge::local(double time, const Vector3d& x) const {
  const Matrix3d path = turn(time * spin_) * path_rotation_;
  const Vector3d in_model = path.transpose() * (x - path_translation_ - time * velocity_);
  return {own_rotation_.transpose() * (in_model - own_translation_), path * own_rotation_};
}

MovingGauge::Slope MovingGauge::slope(double time, const Vector3d& x) const {
  const auto [own, rotation] = local(time, x);
  const auto expansion = (*gauge_)(own);
  return {expansion.value, rotation * expansion.gradient};
}

Vector3d MovingGauge::normal(double time, bool between, const Slope& slope, const Vector3d& x) const {
  Vector3d normal = slope.gradient;
  if (between) {  // the plane touches what is swept: it moves along itself
    const Vector3d along = speed(time, x);
    normal -= along * (normal.dot(along) / along.squaredNorm());
  }
  return normal.allFinite() && normal.norm() > 0.0 ? Vector3d(normal / normal.norm()) : Vector3d::UnitX();
}

Vector3d MovingGauge::own_direction(double time, const Vector3d& direction) const {
  return (turn(time * spin_) * path_rotation_ * own_rotation_).transpose() * direction;
}

double MovingGauge::nearest_time(double begin, double end, const Vector3d& x) const {
  const double first = begin;
  const double length = end - begin;
  const auto derivative = [&](double time) { return -slope(time, x).gradient.dot(speed(time, x)); };
  double at_begin = derivative(begin);
  if (!(at_begin < 0.0)) return begin;
  double at_end = derivative(end);
  if (!(at_end > 0.0)) return end;
  constexpr int most_steps = 40;
  constexpr double close = 1e-5;
  double time = begin;
  for (int step = 0, side = 0; step < most_steps; ++step) {
    const double before = time;
    time = std::clamp((begin * at_end - end * at_begin) / (at_end - at_begin), begin, end);
    if (std::abs(time - before) <= close * length) break;
    const double here = derivative(time);
    if (!std::isfinite(here)) return first;
    // The Illinois method: an end that stays counts half.
    if (here < 0.0) {
      begin = time;
      at_begin = here;
      if (side == -1) at_end /= 2.0;
      side = -1;
    } else {
      end = time;
      at_end = here;
      if (side == 1) at_begin /= 2.0;
      side = 1;
    }
  }
  return time;
}

}  // namespace verisq::verify
