/// One solid refined into cubes as a search asks for them; each cube is evaluated once.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "verify/sets/box_primitive.hpp"
#include "verify/sets/primitive_pair_distance.hpp"
#include "verify/sets/set_tree.hpp"
#include "verify/sets/solid_pair_polytope.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// A model made ready for searches. Immutable.
struct SearchSolid {
  explicit SearchSolid(const Model& model);

  /// A part of the solid, no union, and a cube that contains it.
  struct Part {
    SetNode set;
    Cube cube;
  };

  std::vector<BoxPrimitive> primitives;
  std::vector<SeparablePrimitive> separable;  ///< the same
  std::vector<Part> parts;                    ///< the solid is their union
};

/// The primitives that the set is proven to lie in, as a part of an intersection.
template <class Visit>
void for_each_containing(const SetNode& set, const Visit& visit) {
  const auto visit_leaf = [&](const SetNode& node) {
    if (node.kind == SetNode::Kind::leaf && node.side == Side::inside) visit(node.primitive);
  };
  visit_leaf(set);
  if (set.kind == SetNode::Kind::intersection_of) std::ranges::for_each(set.operands, visit_leaf);
}

/// Whether the cube is proven to lie in the interior of the set.
[[nodiscard]] bool strictly_inside(const SearchSolid& solid, const SetNode& set, const Cube& cube);

/// A polytope that contains the set's part in the cube. Precondition: no union at the top, or else only the cube
/// counts.
[[nodiscard]] CutCube relaxation(const SearchSolid& solid, const SetNode& set, const Cube& cube);

/// Indices from `first` to before `end`.
struct CellRange {
  std::uint32_t first;
  std::uint32_t end;
};

/// What the set that `set` names has in the cube: no less than the solid has there, together with the cell's siblings.
struct Cell {
  CutCube polytope;
  const SetNode* set;   ///< what is left of `part` in the cube; elsewhere it may be another set
  const SetNode* part;  ///< one of SearchSolid::parts
  bool inside;          ///< the cube lies in the interior of the solid
  double slack;         ///< about how far the polytope exceeds the set: what refining may gain; proves nothing
  std::optional<CellRange> children = {};  ///< once asked for
};

/// The cells of one search. A union's operands become cells of their own, so that each has half-spaces to be cut by.
class Cells {
 public:
  explicit Cells(const SearchSolid& solid);

  [[nodiscard]] const Cell& operator[](std::uint32_t index) const { return cells_[index]; }
  [[nodiscard]] std::uint32_t roots() const { return roots_; }  ///< indices 0 to roots() - 1

  /// They contain all that the set has in the cell. Nothing where binary64 cannot halve the cube any more.
  [[nodiscard]] std::optional<CellRange> children(std::uint32_t index);

  [[nodiscard]] std::uint64_t evaluated() const { return evaluated_; }

 private:
  void evaluate(const SetNode& set, const SetNode& part, const Cube& cube);
  void colour_primitives(const SetNode& set, const Cube& cube);
  void add(const SetNode& set, const SetNode& part, const Cube& cube, bool inside);
  void estimate_slack(const CutCube& parent, double slack_of_parent, CellRange children);

  const SearchSolid* solid_;
  std::vector<Cell> cells_;
  std::deque<SetNode> sets_;  ///< a deque, because cells point into it
  std::vector<Colour> colours_;
  std::uint32_t roots_ = 0;
  std::uint64_t evaluated_ = 0;
};

}  // namespace verisq::verify
