/// Boxes of the poses that a fit searches: where they take a point, as the implant sees it (docs/mathematics.md §24).
#pragma once

#include <Eigen/Core>

#include "verify/proposals/box_program.hpp"

namespace verisq::verify {

/// The poses x -> exp(ω) R0 (x - c) + t + τ of an implant: R0 a rotation, c its centre, t where the start puts that.
struct PoseSpace {
  Eigen::Matrix3d start_rotation;  ///< R0, to nearest
  Eigen::Vector3d centre;          ///< c
  Eigen::Vector3d start_centre;    ///< t
};

/// All parameters that differ from the centre's by no more than `half`, each.
struct PoseBox {
  PoseParameters centre;
  PoseParameters half;  ///< >= 0
};

/// What the poses of a box do to points. With δ the difference to the centre's parameters, |δ| <= half, a point v has
/// the place x(δ) in the implant's frame, and for every unit vector n
///     |x(δ) - x(0)| <= reach  and  |n·x(δ) - n·x(0) - slope(n)·δ| <= remainder.
/// Computed to nearest; both bounds have room for what the roundings of a place and of its slopes lose, where the
/// coordinates' magnitudes add up to at most `size`: `rounding(size)`.
class PoseBoxMotion {
 public:
  PoseBoxMotion(const PoseSpace& space, const PoseBox& box, double rounding);

  struct Place {
    Eigen::Vector3d arm;    ///< v - t - τ
    Eigen::Vector3d point;  ///< x(0)
    double reach;
    double remainder;
  };
  [[nodiscard]] Place place(const Eigen::Vector3d& v) const;

  /// Of n·x(δ) at the centre.
  [[nodiscard]] PoseParameters slope(const Place& place, const Eigen::Vector3d& normal) const;

  [[nodiscard]] const PoseParameters& half() const { return half_; }

  /// What fewer than 2^8 roundings of numbers up to `size` make: each is off by at most 2^-53 of it, and what is off
  /// is multiplied by rotations and by sines only.
  [[nodiscard]] static double rounding(double size) { return 0x1p-44 * size; }

 private:
  Eigen::Matrix3d rotation_;  ///< exp(ω) R0 at the centre
  Eigen::Matrix3d jacobian_;  ///< J with exp(ω + δ) = exp(J δ) exp(ω) to first order
  Eigen::Vector3d pivot_;     ///< t + τ
  Eigen::Vector3d centre_;
  PoseParameters half_;
  double moved_;   ///< |τ - centre's|, at most
  double turned_;  ///< |ω - centre's|, at most
  double rounding_;
};

}  // namespace verisq::verify
