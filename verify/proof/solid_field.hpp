/// Distances to a solid for all poses of a box.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "verify/numbers/vector.hpp"
#include "verify/proof/posed_superquadric.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/fit.hpp"
#include "verisq/hidden.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// Boxes of a range of poses, made by halving the range.

/// The three parameters of a translation, then the three of a rotation vector.
constexpr std::size_t pose_parameters = 6;

/// The largest number of divisions of one direction: beyond, boxes are as small as roundings. Shares of the range are
/// exact in binary64.
constexpr std::uint8_t most_divisions = 30;

/// The part with number `index` of 2^`level` parts, in each direction.
struct PoseCell {
  std::array<std::uint32_t, pose_parameters> index{};
  std::array<std::uint8_t, pose_parameters> level{};

  [[nodiscard]] bool can_be_halved(std::size_t direction) const { return level[direction] < most_divisions; }

  /// The two halves; the lower half comes first.
  [[nodiscard]] std::array<PoseCell, 2> halves(std::size_t direction) const {
    PoseCell low = *this;
    ++low.level[direction];
    low.index[direction] *= 2;
    PoseCell high = low;
    ++high.index[direction];
    return {low, high};
  }
};

// Encloses the effect of the poses of a box on points (docs/mathematics.md §24).

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

  /// The slope of n·x(δ), for `turned` = R n.
  [[nodiscard]] PoseSlope slope(const Arm& arm, const IntervalVector& turned) const;

  [[nodiscard]] const std::array<double, pose_parameters>& half() const { return half_; }

  /// No less than |slope·δ|: Σ |slope_k| half_k, rounded up.
  [[nodiscard]] double range_up(const PoseSlope& slope) const;

 private:
  IntervalMatrix rotation_;
  IntervalMatrix inverse_;              ///< R^T
  IntervalMatrix jacobian_transposed_;  ///< transposed J, with exp(ω + δ) = exp(J δ) exp(ω) to first order
  IntervalVector pivot_;
  std::array<double, pose_parameters> half_{};
  double moved_;   ///< |δτ|, at most
  double turned_;  ///< |δω|, at most
};

// Facts about a union of convex primitives near a place, proven when they are first needed: for each primitive a
// half-space that contains it, and a ball inside the union.

/// Contains a primitive: normal·x <= normal·c - at_centre for all its points x, c the field's centre, and |normal|
/// <= 1. So where n·(x - c) + at_centre is positive, the distance from x to the primitive is no less.
struct ContainingHalfSpace {
  Point normal;
  double at_centre;
};

/// A ball in the model: no signed distance of x is more than |x - centre| - radius.
struct ContainedBall {
  Point centre;
  double radius;
};

/// Cubes about the model; the nearer to it, the smaller. The half-spaces and balls of a cube are valid everywhere, but
/// tight only there. Any number of threads may call it.
class SolidField {
 public:
  /// Precondition: a union of convex primitives, at least one.
  SolidField(const Model& model, const Point& centre);
  SolidField(const SolidField&) = delete;
  SolidField& operator=(const SolidField&) = delete;

  class Cube;

  [[nodiscard]] const Point& centre() const;

  /// The cube of the place centre + `from_centre`.
  [[nodiscard]] Cube& near(const Point& from_centre) const;

  /// One half-space for each primitive, in their order. If nothing is proven about a primitive, its normal is 0 and its
  /// `at_centre` minus infinity.
  [[nodiscard]] static std::span<const ContainingHalfSpace> half_spaces(const Cube& cube);
  /// The ball that reaches farthest beyond the middle of the cube, or next to it; nothing far from the model.
  [[nodiscard]] const std::optional<ContainedBall>& ball(Cube& cube) const;

 private:
  struct State;
  Hidden<State> state_;
};

}  // namespace verisq::verify
