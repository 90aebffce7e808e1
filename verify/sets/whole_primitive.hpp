/// A convex primitive as a whole, where others have a cell: its support function is exact, so that it needs no cells.
#pragma once

#include "verify/sets/cube.hpp"
#include "verify/sets/primitive_pair_distance.hpp"

namespace verisq::verify {

class WholePrimitive {
 public:
  /// The cube contains the primitive, which has no bend and must outlive this. Nearest points are as far as they are
  /// but for `tolerance`.
  WholePrimitive(const SeparablePrimitive& primitive, const Cube& cube, double tolerance)
      : primitive_(&primitive), cube_(cube), tolerance_(tolerance) {}

  [[nodiscard]] const Cube& cube() const { return cube_; }

  /// At least the largest direction·(x - the cube's centre) over the primitive.
  [[nodiscard]] double support(const Point& direction) const;

  /// About: proves nothing.
  [[nodiscard]] Point nearest(const Point& x) const;

 private:
  [[nodiscard]] double proven_support(const Point& direction) const;

  const SeparablePrimitive* primitive_;
  Cube cube_;
  double tolerance_;
};

}  // namespace verisq::verify
