/// The steady motion of a leg, enclosed, and poses on its way, to nearest.
#include "verify/sweep/path_moments.hpp"

#include <algorithm>
#include <cmath>

namespace verisq::verify {
namespace {

using Quaternion = std::array<double, 4>;

Quaternion unit(const Quaternion& q) {
  const double size = std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
  return {q[0] / size, q[1] / size, q[2] / size, q[3] / size};
}

/// On the shorter way between two unit quaternions.
Quaternion between(const Quaternion& from, Quaternion to, double share) {
  double cosine = 0.0;
  for (std::size_t i = 0; i < 4; ++i) cosine += from[i] * to[i];
  if (cosine < 0.0) {
    for (double& c : to) c = -c;
    cosine = -cosine;
  }
  const double angle = std::acos(std::min(cosine, 1.0));
  constexpr double small = 1e-8;  // the chord is as good there
  const double a = angle < small ? 1.0 - share : std::sin((1.0 - share) * angle);
  const double b = angle < small ? share : std::sin(share * angle);
  Quaternion q;
  for (std::size_t i = 0; i < 4; ++i) q[i] = a * from[i] + b * to[i];
  return unit(q);
}

}  // namespace

Pose PosedPath::nearby_pose(double time) const {
  const double begin = std::floor(time);
  const auto leg = static_cast<std::size_t>(begin);
  const double share = time - begin;
  if (share == 0.0) return poses_[leg];
  const Pose& from = poses_[leg];
  const Pose& to = poses_[leg + 1];
  Pose pose{{}, between(unit(from.quaternion), unit(to.quaternion), share)};
  for (std::size_t i = 0; i < 3; ++i) pose.translation[i] = std::lerp(from.translation[i], to.translation[i], share);
  return pose;
}

SteadyMotion PosedPath::motion_of(std::size_t leg) const {
  if (poses_.size() == 1) return {};
  const Vector3<double> spin = path_.spin(leg);
  const auto exact = [](const Interval& x) { return PreciseInterval(Real(x.lower()), Real(x.upper())); };
  return {precise(poses_[leg + 1].translation) - precise(poses_[leg].translation),
          {exact(spin[0]), exact(spin[1]), exact(spin[2])}};
}

}  // namespace verisq::verify
