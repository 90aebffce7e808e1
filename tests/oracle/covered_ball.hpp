/// Proves that a ball lies inside a union of solids, hence that its centre is at least so deep.
#pragma once

#include <span>
#include <vector>
#include <verisq/model.hpp>

#include "tests/oracle/mixed_norm.hpp"

namespace verisq::oracle {

/// Covers the ball with cubes, each of which must lie in one solid: solids are convex, so eight corners decide. Works
/// in double with a margin of 1e-9 of the gauge, far above its rounding.
class CoveredBall {
 public:
  explicit CoveredBall(std::span<const Primitive> primitives);

  /// False means only that the cubes, at most 30,000, did not suffice. Precondition: radius > 0.
  [[nodiscard]] bool inside_union(const Point& centre, double radius) const;

 private:
  struct Solid {
    MixedNorm<double> norm;
    Triple<Point> rows;  ///< R^T
    Point translation;

    explicit Solid(const Primitive& primitive);
    [[nodiscard]] bool contains_cube(const Point& centre, double half_edge) const;
  };

  std::vector<Solid> solids_;
};

}  // namespace verisq::oracle
