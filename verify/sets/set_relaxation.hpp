/// The distance of a point to a tree of sets within a cube, bounded from below with half-spaces in place of the leaves.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "verify/sets/box_primitive.hpp"
#include "verify/sets/polytope_distance.hpp"
#include "verify/sets/set_tree.hpp"

namespace verisq::verify {

/// What is proven of the distance of the query to a leaf's whole set, wherever the cube is; 0 says nothing.
using LeafBound = std::function<double(const SetNode& leaf)>;

class SetRelaxation {
 public:
  /// Of the distances of x to what lies in the cube. Each half-space is moved inwards by `margin`, which with anything
  /// but 0 proves nothing of the set any more, and proposes points inside it. Keeps references to its arguments.
  SetRelaxation(const Point& x, const Cube& cube, std::span<const BoxPrimitive> primitives, const LeafBound& leaf_bound,
                double margin = 0.0)
      : x_(x), cube_(cube), primitives_(primitives), leaf_bound_(leaf_bound), margin_(margin) {}

  /// Infinite where nothing of the set lies in the cube. A union's is that of the nearest operand; operands of an
  /// intersection are cut by its leaves' half-spaces together, or by those that x is farthest outside of where there
  /// are many: without the others the bound is lower, and a deep tree costs no more than a wide one.
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

}  // namespace verisq::verify
