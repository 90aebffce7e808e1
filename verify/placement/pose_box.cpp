/// First-order expansions of moved points with their remainders.
#include "verify/placement/pose_box.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace verisq::verify {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Room for the roundings of a norm of three numbers, and for normals in binary32, which are a little longer than 1.
constexpr double kRoundedUp = 1.0 + 0x1p-20;

Matrix3d cross_matrix(const Vector3d& v) {
  Matrix3d cross;
  cross << 0.0, -v[2], v[1], v[2], 0.0, -v[0], -v[1], v[0], 0.0;
  return cross;
}

double sinc(double x) {
  return x == 0.0 ? 1.0 : std::sin(x) / x;
}

/// (x - sin x) / x³, by its series where the difference would lose digits.
double cubic_sinc(double x) {
  if (x >= 1.0) return (x - std::sin(x)) / (x * x * x);
  double term = 1.0 / 6.0;
  double sum = term;
  for (int k = 4; k < 24; k += 2) {
    term *= -x * x / (k * (k + 1));
    sum += term;
  }
  return sum;
}

/// exp(ω) and its left Jacobian: 1 + b W + (...) W², W the matrix of the cross product with ω.
struct Exponential {
  explicit Exponential(const Vector3d& omega) {
    const double angle = omega.norm();
    const Matrix3d cross = cross_matrix(omega);
    const Matrix3d square = cross * cross;
    const double half_sinc = sinc(angle / 2.0);
    const double versine = half_sinc * half_sinc / 2.0;  // (1 - cos) / angle²
    rotation = Matrix3d::Identity() + sinc(angle) * cross + versine * square;
    jacobian = Matrix3d::Identity() + versine * cross + cubic_sinc(angle) * square;
  }
  Matrix3d rotation;
  Matrix3d jacobian;
};

}  // namespace

PoseBoxMotion::PoseBoxMotion(const PoseSpace& space, const PoseBox& box, double rounding)
    : pivot_(space.start_centre + box.centre.head<3>()),
      centre_(space.centre),
      half_(box.half),
      moved_(box.half.head<3>().norm() * kRoundedUp),
      turned_(box.half.tail<3>().norm() * kRoundedUp),
      rounding_(rounding) {
  const Exponential exponential(box.centre.tail<3>());
  rotation_ = exponential.rotation * space.start_rotation;
  jacobian_ = exponential.jacobian;
}

// With y = v - t - τ(0) and R(s) = exp(ω(0) + s δω) R0, x - c = R(1)^T (y - δτ). Rotations along the line turn at
// angular velocity J δω, which is no faster than |δω|: |R(1)^T y - R(0)^T y| <= |δω| |y|, and R^T keeps the length of
// δτ. Second derivatives along the line are at most 3/2 |δω|² |y| (docs/mathematics.md §24): the remainder of R^T y is
// at most 3/4 of that square times |y|; that of R^T δτ is |R(1)^T δτ - R(0)^T δτ| <= |δω| |δτ|.
PoseBoxMotion::Place PoseBoxMotion::place(const Vector3d& v) const {
  const Vector3d arm = v - pivot_;
  const double length = arm.norm();
  return {.arm = arm,
          .point = centre_ + rotation_.transpose() * arm,
          .reach = (moved_ + turned_ * length) * kRoundedUp + rounding_,
          .remainder = turned_ * (0.75 * turned_ * length + moved_) * kRoundedUp + rounding_};
}

// With m = R n: n·R^T (y - δτ) changes by -m·δτ, and where the implant turns by θ = J δω by -m·(θ x y) = θ·(m x y).
PoseParameters PoseBoxMotion::slope(const Place& place, const Vector3d& normal) const {
  const Vector3d turned = rotation_ * normal;
  PoseParameters result;
  result.head<3>() = -turned;
  result.tail<3>() = jacobian_.transpose() * turned.cross(place.arm);
  return result;
}

}  // namespace verisq::verify
