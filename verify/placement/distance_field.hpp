/// Bounds of the signed distance to a union of convex primitives that cost a look-up (docs/mathematics.md §24).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "verify/proof/superquadric.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// A unit normal of a primitive near a point, in the primitive's own frame: a proposal, from which a bound is proven.
using ProposedNormal = std::function<Eigen::Vector3d(std::size_t primitive, const Eigen::Vector3d& local)>;
/// No smaller than the signed distance of each point to the model.
using DistancesUp = std::function<std::vector<double>(std::span<const Point> points)>;

/// The primitive's signed distance at every x is at least normal·x - offset, because it lies in the half-space where
/// that is not positive. |normal| is 1 but for roundings. In binary32: many more fit into a cache.
struct RoundedHalfSpace {
  Eigen::Vector3f normal;
  float offset;

  [[nodiscard]] double distance(const Eigen::Vector3d& x) const { return direction().dot(x) - offset; }
  [[nodiscard]] Eigen::Vector3d direction() const { return normal.cast<double>(); }
};

/// A ball in the model: the signed distance of x is at most |x - centre| - radius.
struct InnerBall {
  Eigen::Vector3d centre;
  double radius;  ///< negative: there is none
};

/// Nested grids of nodes about the model, finer where it is. Each node knows the half-spaces of the two primitives
/// nearest to it and how far the others are, those of the finest grid a ball, too. What they say holds everywhere; near
/// the node it is tight.
class DistanceField {
 public:
  struct Node {
    std::array<RoundedHalfSpace, 2> nearest;
    float others;       ///< no larger than the distance of the node to any other primitive
    std::int32_t ball;  ///< index, -1 where there is none
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
    double per_length;  ///< of nodes
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
    Eigen::Vector3d half_sides;  ///< of its box, rounded up
  };

  [[nodiscard]] Grid grid(double margin, double spacing) const;
  [[nodiscard]] Node node(const Eigen::Vector3d& x, const ProposedNormal& normal) const;
  [[nodiscard]] double distance_to_box(const PosedPrimitive& primitive, const Eigen::Vector3d& local) const;
  [[nodiscard]] RoundedHalfSpace half_space(const PosedPrimitive& primitive, const Eigen::Vector3d& local_normal) const;

  std::vector<PosedPrimitive> primitives_;
  Eigen::Vector3d lower_, upper_;  ///< of the model's box
  double smallest_;                ///< semi-axis
  double rounding_;                ///< of binary64
  double slack_;                   ///< of binary32
  std::vector<Grid> grids_;        ///< from fine to coarse
  std::vector<InnerBall> balls_;
};

}  // namespace verisq::verify
