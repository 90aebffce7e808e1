/// Bounds of models as wholes: boxes around models, colours and half-spaces of primitives over cubes, and trees of set
/// operations.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "verify/numbers/vector.hpp"
#include "verify/proof/posed_superquadric.hpp"
#include "verify/proof/verdict.hpp"
#include "verify/proposals/gjk.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verify/solids/cube.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/hidden.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

class PosedMesh;

// One posed primitive, bent or not, or a closed mesh, over cubes of the model frame: inclusion functions of second
// order.

/// Every statement is proven by outward-rounded intervals with binary64 ends. Over a cube of half-width h the
/// coordinates in the primitive's own frame are an affine function of the position, up to a remainder of order h^2 (0
/// without a bend). The gauge is convex: half-spaces are loose by the order h^2 only. A mesh has colours and
/// half-spaces of closed_mesh.hpp.
class BoxPrimitive {
 public:
  /// Throws as ClosedMesh for a mesh.
  explicit BoxPrimitive(const Primitive& primitive);

  /// Colour of the primitive K itself. For a point: black where g < 1 is proven, white where g > 1 is.
  [[nodiscard]] Colour colour(const Cube& cube) const;

  /// A half-space that contains the part of K, or of the closure of its complement, in the cube.
  [[nodiscard]] HalfSpace half_space(const Cube& cube, Side side) const;

  /// Null for a superquadric.
  [[nodiscard]] const PosedMesh* mesh() const { return mesh_.get(); }

 private:
  struct State;
  Hidden<State> state_;  ///< of a superquadric
  Hidden<PosedMesh> mesh_;
};

// Bounds of models as wholes: boxes around them, and enclosures of trees of set operations over cubes.

// Set operations: their tree, its terms, the colours of boxes.

// Trees of set operations over cubes: three-valued logic of colours, and Duff's simplification
// (docs/mathematics.md §11).

/// Unions and intersections alone: differences and complements have moved to the leaves (De Morgan).
struct SetNode {
  enum class Kind : std::uint8_t { leaf, union_of, intersection_of };

  Kind kind;
  std::uint32_t primitive = 0;  ///< for a leaf
  Side side = Side::inside;     ///< of a leaf
  std::vector<SetNode> operands = {};
};

/// The model's solid, or with Side::outside the closure of its complement.
[[nodiscard]] SetNode normal_form(const Model& model, Side side);

/// Primitives whose union contains the solid, ascending, once each: every point of the solid lies in one of them. For a
/// union these are all its primitives; for an intersection those of the first operand that has some, so that removed
/// primitives are not among them.
[[nodiscard]] std::vector<std::uint32_t> covering_primitives(const Model& model);

/// The number of primitives, or of the tree's leaves if there are more of them: the work that one cube may take.
[[nodiscard]] std::size_t size_of_tree(const Model& model);

/// Colour of the set whose primitives K_i (not their complements) have these colours over a cube. A boundary that two
/// operands share may stay gray.
[[nodiscard]] Colour colour(const SetNode& node, std::span<const Colour> primitives);

/// The colour of the cube's part of the boundary of the primitive `surface`. The boundary is part of the primitive and
/// of the closure of its complement alike. Black if that part lies in the set.
[[nodiscard]] Colour colour_of_surface(const SetNode& node, std::span<const Colour> primitives, std::uint32_t surface);

/// Primitives with leaves on both sides, ascending: A - (A - B) leaves the boundary of A.
[[nodiscard]] std::vector<std::uint32_t> on_both_sides(const SetNode& node);

/// The shorter tree that is the same set within a cube over which the primitives have these colours. Precondition:
/// colour(node, primitives) is gray.
[[nodiscard]] SetNode simplified(const SetNode& node, std::span<const Colour> primitives);

// Trees of set operations as unions of intersections: the disjunctive normal form (docs/mathematics.md §11).

/// The intersection of primitives, and of closures of complements of primitives: a bit each.
struct SetTerm {
  std::uint32_t inside = 0;
  std::uint32_t outside = 0;

  friend bool operator==(const SetTerm&, const SetTerm&) = default;
};

/// Terms whose union is the set; no term contains another one. Nothing if a primitive has no bit, or if more than
/// `most` terms arise on the way.
[[nodiscard]] std::optional<std::vector<SetTerm>> terms_of(const SetNode& tree, std::size_t most);

// Colours of the primitives of a tree over cubes: primitives outside the tree cost nothing, however large the model.

/// Works in its own memory: one for each thread.
class TreeColours {
 public:
  /// Keeps a reference to the primitives.
  explicit TreeColours(std::span<const BoxPrimitive> primitives)
      : primitives_(primitives), colours_(primitives.size(), Colour::gray), looked_at_(primitives.size(), 0) {}

  /// The colours of the primitives of the tree's leaves; each is evaluated once. Colours of other primitives are
  /// meaningless. Valid until the next call.
  [[nodiscard]] std::span<const Colour> operator()(const SetNode& tree, const Cube& cube) {
    ++cube_;
    any_decided_ = false;
    look_at(tree, cube);
    return colours_;
  }

  /// Returns whether one of these primitives is not gray.
  [[nodiscard]] bool any_decided() const { return any_decided_; }

 private:
  void look_at(const SetNode& node, const Cube& cube) {
    if (node.kind == SetNode::Kind::leaf && looked_at_[node.primitive] != cube_) {
      looked_at_[node.primitive] = cube_;
      colours_[node.primitive] = primitives_[node.primitive].colour(cube);
      any_decided_ = any_decided_ || colours_[node.primitive] != Colour::gray;
    }
    for (const SetNode& operand : node.operands) look_at(operand, cube);
  }

  std::span<const BoxPrimitive> primitives_;
  std::vector<Colour> colours_;
  std::vector<std::uint64_t> looked_at_;  ///< the latest cube of each
  std::uint64_t cube_ = 0;
  bool any_decided_ = false;
};

// Boxes and half-spaces that hold a solid.

// Boxes of points in interval arithmetic: their intersection, and their binary64 form.

[[nodiscard]] inline Enclosure rounded_outward(const PreciseInterval& x) {
  return {x.lower().to_double(Direction::down), x.upper().to_double(Direction::up)};
}

[[nodiscard]] inline std::array<Enclosure, 3> rounded_outward(const PreciseVector& box) {
  return {rounded_outward(box[0]), rounded_outward(box[1]), rounded_outward(box[2])};
}

/// Both intervals contain the same number, which `what` names; throws Error(failure) if they have nothing in common.
[[nodiscard]] inline PreciseInterval intersection(const PreciseInterval& x, const PreciseInterval& y,
                                                  std::string_view what) {
  const Real lower = std::max(x.lower(), y.lower());
  const Real upper = std::min(x.upper(), y.upper());
  if (!(lower <= upper)) report_contradiction(rounded_outward(x), rounded_outward(y), std::string(what));
  return {lower, upper};
}

/// Both boxes contain the same point.
[[nodiscard]] inline PreciseVector intersection(const PreciseVector& x, const PreciseVector& y, std::string_view what) {
  return {intersection(x[0], y[0], what), intersection(x[1], y[1], what), intersection(x[2], y[2], what)};
}

[[nodiscard]] inline bool subset(const PreciseInterval& inner, const PreciseInterval& outer) {
  return outer.lower() <= inner.lower() && inner.upper() <= outer.upper();
}

/// All points at most `radius` from one of the box in every coordinate.
[[nodiscard]] inline PreciseVector inflated(const PreciseVector& box, const Real& radius) {
  const PreciseInterval about(-radius, radius);
  return {box[0] + about, box[1] + about, box[2] + about};
}

/// The lower ends: a single point, for proposals.
[[nodiscard]] inline PreciseVector thin(const PreciseVector& x) {
  return {x[0].lower(), x[1].lower(), x[2].lower()};
}

// Boxes of the model frame that contain models.

/// {x : lower <= x <= upper}; an end that overflows is infinite.
struct Box {
  Point lower;
  Point upper;
};

/// The smallest box that contains both.
[[nodiscard]] Box hull(const Box& a, const Box& b);

using BoxOfPrimitive = std::function<Box(std::uint32_t primitive)>;

/// Contains the tree's set, from boxes that contain its leaves' primitives. Each leaf's box is computed at most once: a
/// difference does not need the operands that it removes.
[[nodiscard]] Box bounding_box(const SetExpression& expression, const BoxOfPrimitive& box_of_primitive);

/// Contains the model's solid: for a union the hull of its primitives' boxes, for an intersection the common part of
/// the boxes (the first box if they have nothing in common), for a difference the first operand's box. A primitive's
/// box encloses the box of its own frame, bent if the primitive is bent (only the part of the bend's plane that the
/// solid reaches), and posed.
[[nodiscard]] Box bounding_box(const Model& model);

// The approximate place of a solid, as a start for searches: proves nothing.

/// A ball about the middle of its bounding box.
struct SolidExtent {
  Point centre;
  double radius;
};

[[nodiscard]] SolidExtent extent_of(const Model& model);

// Bounds by half-spaces for all points of a triangle: how deep they lie in a union of convex primitives at most, or how
// far from it at least (docs/mathematics.md §15).

/// The bound is off by the square of the triangle's size; a ball about one of its points is off by its size. Immutable:
/// safe to call from many threads.
class HalfSpaceBound {
 public:
  /// Precondition: is_union_of_convex(model).
  explicit HalfSpaceBound(const Model& model);

  /// A lower bound of the signed distances of all points of the triangle. Minus infinity if two primitives may contain
  /// one of these points: it may lie deeper in their union than in each. Precondition: finite.
  [[nodiscard]] double operator()(const Triangle& triangle) const;

 private:
  struct Solid {
    PosedSuperquadric posed;
    NearestNormal nearest;
    SuperquadricSet<double> set;
  };

  [[nodiscard]] static double lower(const Solid& solid, const Triangle& triangle);

  std::vector<Solid> solids_;
};

}  // namespace verisq::verify
