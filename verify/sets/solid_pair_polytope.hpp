/// Polytopes that contain what a set has in a cube: proven support bounds, proposed projections.
#pragma once

#include <array>
#include <span>

#include "verify/sets/cube.hpp"

namespace verisq::verify {

/// The part of a cube in up to three half-spaces; more would be valid, and of little use.
class CutCube {
 public:
  /// Ignores half-spaces that say nothing, and all beyond the third.
  CutCube(const Cube& cube, std::span<const HalfSpace> half_spaces);

  [[nodiscard]] const Cube& cube() const { return cube_; }
  [[nodiscard]] std::span<const HalfSpace> half_spaces() const { return {half_spaces_.data(), count_}; }

  /// At least the largest direction·(x - centre) over the polytope. By duality: for any multipliers m >= 0 it is at
  /// most h |direction - sum m_j n_j|_1 + sum m_j b_j. The least of that, but for rounding, for up to two half-spaces.
  [[nodiscard]] double support(const Point& direction) const;

  /// All faces moved inwards by `margin`, which is at most the half-width: well within the polytope, or empty.
  [[nodiscard]] CutCube shrunk(double margin) const;

  /// The point of the polytope nearest to x, about: proves nothing.
  [[nodiscard]] Point nearest(const Point& x) const;

 private:
  Cube cube_;
  std::array<HalfSpace, 3> half_spaces_{};
  std::size_t count_ = 0;
};

}  // namespace verisq::verify
