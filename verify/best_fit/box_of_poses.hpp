/// What the poses of a box do to points, enclosed (docs/mathematics.md §24).
#pragma once

#include <array>

#include "verify/best_fit/pose_cell.hpp"
#include "verify/numbers/vector.hpp"
#include "verisq/model.hpp"
#include "verisq/pose_range.hpp"

namespace verisq::verify {

using IntervalVector = Vector3<double>;
using IntervalMatrix = Matrix3<double>;
using PoseSlope = std::array<Interval, pose_parameters>;

/// The poses x -> exp(ω) R0 (x - c) + (R0 c + t) + τ of an implant: R0, t the start, |τ_i| and |ω_i| bounded.
class RangeOfPoses {
 public:
  /// Precondition: finite numbers, no zero quaternion.
  RangeOfPoses(const PoseRange& range, const Point& centre);

  [[nodiscard]] const PreciseMatrix& start_rotation() const { return start_rotation_; }
  [[nodiscard]] const IntervalVector& start_centre() const { return start_centre_; }  ///< R0 c + t
  [[nodiscard]] double end(std::size_t direction) const { return ends_[direction]; }  ///< of |parameter|, rounded up

 private:
  PreciseMatrix start_rotation_;
  IntervalVector start_centre_;
  std::array<double, pose_parameters> ends_{};
};

/// With δ the difference to the parameters of the box's centre, |δ| <= half, R the rotation there and x(δ) the place
/// of a point v as the implant sees it, for every n with |n| <= 1
///     n·x(0) = n·c + n·from_centre,   |x(δ) - x(0)| <= reach,   |n·x(δ) - n·x(0) - slope·δ| <= remainder.
class BoxOfPoses {
 public:
  BoxOfPoses(const RangeOfPoses& range, const PoseCell& cell);

  struct Arm {
    IntervalVector from_pivot;   ///< v - (R0 c + t) - τ
    IntervalVector from_centre;  ///< R^T of that: x(0) - c
    double reach;
    double remainder;
  };
  [[nodiscard]] Arm arm(const Point& v) const;

  [[nodiscard]] const IntervalMatrix& rotation() const { return rotation_; }
  /// R0 c + t + τ
  [[nodiscard]] const IntervalVector& pivot() const { return pivot_; }

  /// Of n·x(δ), for `turned` = R n.
  [[nodiscard]] PoseSlope slope(const Arm& arm, const IntervalVector& turned) const;

  [[nodiscard]] const std::array<double, pose_parameters>& half() const { return half_; }

  /// No less than |slope·δ|: Σ |slope_k| half_k, rounded up.
  [[nodiscard]] double range_up(const PoseSlope& slope) const;

 private:
  IntervalMatrix rotation_;
  IntervalMatrix inverse_;              ///< R^T
  IntervalMatrix jacobian_transposed_;  ///< of J with exp(ω + δ) = exp(J δ) exp(ω) to first order
  IntervalVector pivot_;
  std::array<double, pose_parameters> half_{};
  double moved_;   ///< |δτ|, at most
  double turned_;  ///< |δω|, at most
};

}  // namespace verisq::verify
