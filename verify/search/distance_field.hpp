/// Distances of points to a model that lies in any pose of a box.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "verify/numbers/points.hpp"
#include "verify/proposals/multipliers.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// The one way in which a pose's quaternion becomes a rotation of Eigen's.

/// q/|q|, to a few roundings of its components, for any length. Eigen alone squares its operand, and does not change a
/// quaternion of length 1e-200. Precondition: finite, not 0.
[[nodiscard]] inline Eigen::Quaterniond unit_quaternion(const std::array<double, 4>& quaternion) {
  const auto [w, x, y, z] = near_one(quaternion);
  return Eigen::Quaterniond(w, x, y, z).normalized();
}

// Boxes of the poses that a fit searches, and the places of a point in them, as the implant sees it
// (docs/mathematics.md §24).

/// The poses x -> exp(ω) R0 (x - c) + t + τ of an implant: R0 a rotation, c its centre, t the place of c in the start
/// pose.
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

/// The effect of the poses of a box on points. With δ the difference to the centre's parameters, |δ| <= half, a point v
/// has the place x(δ) in the implant's frame, and for every unit vector n
///     |x(δ) - x(0)| <= reach  and  |n·x(δ) - n·x(0) - slope(n)·δ| <= remainder.
/// Computed to nearest. Both bounds have room for the roundings of a place and of its slopes, `rounding(size)`, if the
/// coordinates' magnitudes add up to at most `size`.
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

  /// The slope of n·x(δ) at the centre.
  [[nodiscard]] PoseParameters slope(const Place& place, const Eigen::Vector3d& normal) const;

  [[nodiscard]] const PoseParameters& half() const { return half_; }

  /// The range in which `size` must lie.
  static constexpr double smallest_size = 0x1p-100;
  static constexpr double largest_size = 0x1p100;
  /// A bound of fewer than 2^8 roundings of numbers up to `size`. Each is off by at most 2^-53 of it, and errors are
  /// multiplied by rotations and by sines only. Underflow is far less: lengths whose squares vanish are below 2^-537.
  /// Angles below that move points by less than 2^-437, while this bound is at least 2^-144. No square overflows.
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

// Bounds of the signed distance to a union of convex primitives that cost a look-up (docs/mathematics.md §24).

/// A unit normal of a primitive near a point, in the primitive's own frame: a proposal, from which a bound is proven.
using ProposedNormal = std::function<Eigen::Vector3d(std::size_t primitive, const Eigen::Vector3d& local)>;
/// Returns upper bounds of the signed distances of the points to the model.
using DistancesUp = std::function<std::vector<double>(std::span<const Point> points)>;

/// The primitive's signed distance at every x is at least normal·x - offset, because the primitive lies in the
/// half-space where that is not positive. |normal| is 1 but for roundings. In binary32: many more fit into a cache.
struct RoundedHalfSpace {
  Eigen::Vector3f normal;
  float offset;

  [[nodiscard]] double distance(const Eigen::Vector3d& x) const { return direction().dot(x) - offset; }
  [[nodiscard]] Eigen::Vector3d direction() const { return normal.cast<double>(); }
};

/// A ball in the model: the signed distance of x is at most |x - centre| - radius.
struct InnerBall {
  Eigen::Vector3d centre;
  double radius;  ///< negative: there is no ball
};

/// Nested grids of nodes about the model, finer near it. Each node stores the half-spaces of the two nearest primitives
/// and a lower bound of the distance of the others. A node of the finest grid also stores a ball. These bounds are
/// valid everywhere, and tight near the node.
class DistanceField {
 public:
  struct Node {
    std::array<RoundedHalfSpace, 2> nearest;
    float others;       ///< no larger than the distance of the node to any other primitive
    std::int32_t ball;  ///< index, -1 if there is none
  };
  struct Found {
    const Node& node;
    Eigen::Vector3d place;  ///< the node's
  };

  /// `extent` is how far from the model points matter. Bounds have room for roundings of coordinates whose magnitudes
  /// add up to at most `size`. Precondition: at least one primitive, none bent.
  DistanceField(const Model& model, double extent, double size);

  /// Nodes are found slab by slab, by any threads; then balls.
  [[nodiscard]] std::size_t slabs() const;
  void find_slab(std::size_t slab, const ProposedNormal& normal);
  void find_balls(const DistancesUp& distances_up);

  [[nodiscard]] Found near(const Eigen::Vector3d& x) const;
  [[nodiscard]] const InnerBall& ball(const Node& node) const { return balls_[static_cast<std::size_t>(node.ball)]; }

 private:
  struct Grid {
    Eigen::Vector3d lower;
    double spacing;
    double per_length;  ///< number of nodes per length
    std::array<std::int32_t, 3> count;
    std::vector<Node> nodes;

    [[nodiscard]] bool contains(const Eigen::Vector3d& x) const;
    [[nodiscard]] std::size_t index(const Eigen::Vector3d& x) const;
    [[nodiscard]] Eigen::Vector3d place(std::size_t index) const;
  };
  struct PosedPrimitive {
    SuperquadricBounds<double> bounds;
    Eigen::Matrix3d rotation;
    Eigen::Vector3d translation;
    Eigen::Vector3d focus;       ///< about which the support function is, in the frame of the model
    Eigen::Vector3d half_sides;  ///< half the sides of its box, rounded up
  };

  [[nodiscard]] Grid grid(double margin, double spacing) const;
  [[nodiscard]] Node node(const Eigen::Vector3d& x, const ProposedNormal& normal) const;
  [[nodiscard]] double distance_to_box(const PosedPrimitive& primitive, const Eigen::Vector3d& local) const;
  [[nodiscard]] RoundedHalfSpace half_space(const PosedPrimitive& primitive, const Eigen::Vector3d& local_normal) const;

  std::vector<PosedPrimitive> primitives_;
  Eigen::Vector3d lower_, upper_;  ///< corners of the model's box
  double smallest_;                ///< semi-axis
  double rounding_;                ///< error bound of binary64
  double slack_;                   ///< error bound of binary32
  std::vector<Grid> grids_;        ///< from fine to coarse
  std::vector<InnerBall> balls_;
};

}  // namespace verisq::verify
