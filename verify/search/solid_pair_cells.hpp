/// Two solids of any kind: cells, bounds and points of a branch and bound.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "verify/proof/pair_checker.hpp"
#include "verify/search/polytope_distance.hpp"
#include "verify/search/primitive_pair_distance.hpp"
#include "verify/search/set_tree.hpp"
#include "verify/solids/cube.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// The motion of the second model: precise for the final statements, and in binary64 with an error bound for the search.

/// From the frame of B to that of A: x -> R x + t.
class BoundedMotion {
 public:
  explicit BoundedMotion(const Pose& pose);

  // Approximate: these prove nothing.
  [[nodiscard]] Point to_a(const Point& in_b) const;
  [[nodiscard]] Point to_b(const Point& in_a) const;

  /// R^T direction, but for an error of at most `rotation_error` |direction|_1 in each component.
  [[nodiscard]] Point direction_in_b(const Point& direction) const;
  static constexpr double rotation_error = 0x1p-50;

  /// t itself.
  [[nodiscard]] const Point& translation() const { return translation_; }

  /// |R b + t - a|, rounded up.
  [[nodiscard]] double distance_up(const Point& a, const Point& b) const;

  /// A cube of B's frame that contains R^T (x - t).
  [[nodiscard]] Cube enclosed_in_b(const Point& x) const;

 private:
  RigidMotion precise_;
  RigidMotion inverse_;
  std::array<Point, 3> rotation_;  ///< rows of R, to nearest
  Point translation_;
};

// One solid refined into cubes on demand; each cube is evaluated once.

/// A model made ready for searches. Immutable.
struct SearchSolid {
  explicit SearchSolid(const Model& model);

  /// A part of the solid, no union, and a cube that contains it.
  struct Part {
    SetNode set;
    Cube cube;
  };

  std::vector<BoxPrimitive> primitives;
  std::vector<SeparablePrimitive> separable;  ///< the same primitives
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

/// Returns whether the cube is proven to lie in the interior of the set.
[[nodiscard]] bool strictly_inside(const SearchSolid& solid, const SetNode& set, const Cube& cube);

/// A polytope that contains the set's part in the cube. Precondition: no union at the top; for one only the cube is
/// used.
[[nodiscard]] CutCube relaxation(const SearchSolid& solid, const SetNode& set, const Cube& cube);

/// Indices from `first` to before `end`.
struct CellRange {
  std::uint32_t first;
  std::uint32_t end;
};

/// The part of the set `set` in the cube. Together with its siblings it contains at least the solid's part in the cube.
struct Cell {
  CutCube polytope;
  const SetNode* set;   ///< the simplified `part` in the cube; elsewhere it may be another set
  const SetNode* part;  ///< one of SearchSolid::parts
  bool inside;          ///< the cube lies in the interior of the solid
  double slack;         ///< about how far the polytope exceeds the set, the possible gain of refining; proves nothing
  std::optional<CellRange> children = {};  ///< set once they are needed
};

/// The cells of one search. A union's operands become cells of their own, so that half-spaces can cut each of them.
class Cells {
 public:
  explicit Cells(const SearchSolid& solid);

  [[nodiscard]] const Cell& operator[](std::uint32_t index) const { return cells_[index]; }
  [[nodiscard]] std::uint32_t roots() const { return roots_; }  ///< indices 0 to roots() - 1

  /// The children contain all of the set's part in the cell. Nothing if binary64 cannot halve the cube any more.
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

// Lower bounds of the distance of two convex sets, one of which is moved.

/// n / |n|, about; zero if n is zero, or has no direction.
[[nodiscard]] Point unit(const Point& n);

/// The requirements of a bound on a set: a cube that contains it; an upper bound of direction·(x - the cube's centre)
/// over it; and about its point nearest to x.
template <class T>
concept Separable = requires(const T& set, const Point& x) {
  { set.cube() } -> std::same_as<const Cube&>;
  { set.support(x) } -> std::same_as<double>;
  { set.nearest(x) } -> std::same_as<Point>;
};

/// A lower bound of the distance, at least 0: proven by the slab between the planes normal to n. n is in the frame of
/// A, like x, and has a length of about 1. Any n is valid.
template <Separable X, Separable Y>
[[nodiscard]] double lower_by_direction(const X& x, const Y& y, const BoundedMotion& motion, const Point& n);

/// The result of alternating projections.
struct Approach {
  double lower;    ///< proven
  double between;  ///< |on_b moved - on_a|, about: the possible gain between the sets
  Point on_a;      ///< in the frame of A; in the set, about
  Point on_b;      ///< in the frame of B
};

/// Stops as soon as `lower` is at least `enough`. `guess` is a direction from A to B; it may be poor, or zero.
template <Separable X, Separable Y>
[[nodiscard]] Approach approach(const X& x, const Y& y, const BoundedMotion& motion, const Point& guess, double enough);

// Instantiated for two cut cubes, or a cut cube and a whole primitive.
extern template double lower_by_direction(const CutCube&, const CutCube&, const BoundedMotion&, const Point&);
extern template Approach approach(const CutCube&, const CutCube&, const BoundedMotion&, const Point&, double);
extern template Approach approach(const WholePrimitive&, const CutCube&, const BoundedMotion&, const Point&, double);
extern template Approach approach(const CutCube&, const WholePrimitive&, const BoundedMotion&, const Point&, double);

// Upper bounds of the distance of two solids: points proven to lie in them, improved as long as that pays.

/// A point of each, in their own frames, and their distance, rounded up.
struct NearPoints {
  Point on_a;
  Point on_b;
  double distance;
};

class PointSearch {
 public:
  /// All must outlive this.
  PointSearch(const SearchSolid& a, const SearchSolid& b, const BoundedMotion& motion)
      : a_(&a), b_(&b), motion_(&motion) {}

  /// Points proven to lie in the cells' parts, next to the proposed ones; nothing where the proof fails. `scale` is the
  /// size of the cells. The cells' own sets lead there, and prove nothing, because points may leave the cubes.
  [[nodiscard]] std::optional<NearPoints> settled(const Cell& x, const Cell& y, const Point& near_a,
                                                  const Point& near_b, double scale) const;

  /// The same if planes do not determine the shape, as at tips.
  [[nodiscard]] std::optional<NearPoints> settled_towards_centres(const Cell& x, const Cell& y, const Point& near_a,
                                                                  const Point& near_b) const;

  /// Descends to closer points of the same parts, until a step within a cube of the half-width `scale` or less promises
  /// no more than `gain`.
  [[nodiscard]] NearPoints improved(const Cell& x, const Cell& y, NearPoints points, double scale, double gain) const;

  /// Returns whether `at`, of A's frame, is proven to lie in both cells' parts.
  [[nodiscard]] bool common(const Cell& x, const Cell& y, const Point& at) const;

 private:
  [[nodiscard]] std::optional<NearPoints> both(const std::optional<Point>& on_a,
                                               const std::optional<Point>& on_b) const;

  const SearchSolid* a_;
  const SearchSolid* b_;
  const BoundedMotion* motion_;
};

}  // namespace verisq::verify
