/// Relaxations of solids to polytopes, and distances to these.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "verify/search/set_tree.hpp"
#include "verify/solids/cube.hpp"

namespace verisq::verify {

// Proven lower bounds of distances to a cube cut by half-spaces, by Lagrange multipliers.

struct PolytopeDistance {
  double lower;   ///< proven; infinite where the polytope is proven empty
  Point nearest;  ///< nearest to the query, about: proves nothing
};

/// Distance of x to the part of the cube in all half-spaces. Any multipliers m_j >= 0 prove
/// |e - x|^2 >= min over the cube of |e - x|^2 + 2 sum m_j (n_j.e - b_j), which is a sum over the coordinates.
[[nodiscard]] PolytopeDistance polytope_distance(const Point& x, const Cube& cube,
                                                 std::span<const HalfSpace> half_spaces);

// The distance of a point to a tree of sets within a cube, bounded from below with half-spaces in place of the leaves.

/// A proven lower bound of the distance of the query to a leaf's whole set, independent of the cube; 0 proves nothing.
using LeafBound = std::function<double(const SetNode& leaf)>;

class SetRelaxation {
 public:
  /// Bounds the distances of x to the set's part in the cube. Each half-space is moved inwards by `margin`. With any
  /// margin but 0 nothing is proven about the set; the result then proposes points inside it. Keeps references to its
  /// arguments.
  SetRelaxation(const Point& x, const Cube& cube, std::span<const BoxPrimitive> primitives, const LeafBound& leaf_bound,
                double margin = 0.0)
      : x_(x), cube_(cube), primitives_(primitives), leaf_bound_(leaf_bound), margin_(margin) {}

  /// Infinite if the set has no part in the cube. The bound of a union is that of the nearest operand. Operands of an
  /// intersection are cut by its leaves' half-spaces together; if there are many, by those outside of which x is
  /// farthest. Without the others the bound is lower, and a deep tree costs no more than a wide one.
  [[nodiscard]] PolytopeDistance operator()(const SetNode& node) const { return distance(node, {}); }

 private:
  [[nodiscard]] PolytopeDistance distance(const SetNode& node, std::vector<HalfSpace> cuts) const;
  [[nodiscard]] PolytopeDistance union_distance(const SetNode& node, const std::vector<HalfSpace>& cuts) const;
  [[nodiscard]] PolytopeDistance intersection_distance(const SetNode& node, std::vector<HalfSpace> cuts) const;
  void keep_farthest(std::vector<HalfSpace>& cuts) const;
  [[nodiscard]] HalfSpace half_space(const SetNode& leaf) const;

  const Point& x_;
  const Cube& cube_;
  std::span<const BoxPrimitive> primitives_;
  const LeafBound& leaf_bound_;
  double margin_;
};

// Polytopes that contain a set's part in a cube: proven support bounds, proposed projections.

/// The part of a cube in up to three half-spaces; more would be valid, and of little use.
class CutCube {
 public:
  /// Ignores half-spaces without effect, and all beyond the third.
  CutCube(const Cube& cube, std::span<const HalfSpace> half_spaces);

  [[nodiscard]] const Cube& cube() const { return cube_; }
  [[nodiscard]] std::span<const HalfSpace> half_spaces() const { return {half_spaces_.data(), count_}; }

  /// At least the largest direction·(x - centre) over the polytope. By duality, for any multipliers m >= 0, it is at
  /// most h |direction - sum m_j n_j|_1 + sum m_j b_j. The result is the least such bound, but for rounding, for up to
  /// two half-spaces.
  [[nodiscard]] double support(const Point& direction) const;

  /// The polytope with all faces moved inwards by `margin`, at most the half-width: well within the polytope, or empty.
  [[nodiscard]] CutCube shrunk(double margin) const;

  /// The point of the polytope nearest to x, about: proves nothing.
  [[nodiscard]] Point nearest(const Point& x) const;

 private:
  Cube cube_;
  std::array<HalfSpace, 3> half_spaces_{};
  std::size_t count_ = 0;
};

}  // namespace verisq::verify
