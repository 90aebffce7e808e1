/// Proves that a neighbourhood of a point, triangle or convex body contains no point of a set, by a cover of cells;
/// each cell is proven on its own.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "verify/proof/posed_superquadric.hpp"
#include "verisq/checker.hpp"
#include "verisq/mesh.hpp"

namespace verisq::verify {

/// The place of a region relative to a set: the region has no point of the set, or lies in its interior.
enum class Place : std::int8_t { outside = -1, undecided = 0, inside = 1 };

/// The place of a region relative to the set, from its places relative to the primitives (docs/mathematics.md §11).
[[nodiscard]] Place place_of(const SetExpression& set, std::span<const Place> primitives);

/// The place of all points of the box x. Precondition: finite.
[[nodiscard]] Place place_of(const PreciseVector& x, const PosedPrimitive& primitive);
[[nodiscard]] Place place_of(const PreciseVector& x, const SetExpression& set,
                             std::span<const PosedPrimitive> primitives);

/// A region with a known support function. All vectors are from its centre, a point beside it.
class ConvexBody {
 public:
  ConvexBody() = default;
  ConvexBody(const ConvexBody&) = default;
  ConvexBody& operator=(const ConvexBody&) = default;
  virtual ~ConvexBody() = default;

  /// No smaller than v·x for any point x.
  [[nodiscard]] virtual Real reach(const PreciseVector& v) const = 0;
  /// About the point that is farthest along v: proves nothing.
  [[nodiscard]] virtual std::array<double, 3> farthest(const std::array<double, 3>& v) const = 0;
};

/// The neighbourhood consists of the points nearer than `radius` to a point, triangle or convex body. The question for
/// each cell: does its part of the neighbourhood contain a point of the set? With Place::inside: a point of the closure
/// of the set's complement (docs/mathematics.md §28)?
class EmptyNeighbourhood {
 public:
  /// A box relative to `centre()`: exact.
  struct Cell {
    std::array<Real, 3> offset, half;
  };
  static constexpr std::size_t longest_cover = 1U << 16U;  ///< a checker's work is bounded

  /// Each of the normals may prove on which side of its primitive the whole neighbourhood lies. `near` is a point
  /// beside the nearest point of the set; half-spaces are built from it. `interrupted`, unless empty, is polled; once
  /// it returns true, the normals prove nothing more. Keeps references to the set and its primitives. Preconditions:
  /// finite, radius > 0; normals of primitives that exist; for a triangle Place::outside is wanted.
  template <class PointOrTriangle>
  EmptyNeighbourhood(const SetExpression& set, std::span<const PosedPrimitive> primitives, const PointOrTriangle& query,
                     double radius, Place wanted, std::span<const Normal> normals, const std::optional<Point>& near,
                     const Hook& interrupted = {});

  /// The neighbourhood of a body about `centre`; keeps a reference to the body, too. Place::outside is wanted.
  EmptyNeighbourhood(const SetExpression& set, std::span<const PosedPrimitive> primitives, const ConvexBody& body,
                     const Point& centre, double radius);

  /// The neighbourhood of a cube about any point of the box `centre`: all of the cube, described as a ball that
  /// contains it.
  EmptyNeighbourhood(const SetExpression& set, std::span<const PosedPrimitive> primitives, const PreciseVector& centre,
                     const Real& half_width, Place wanted);

  /// Returns whether all cells of the cover, as Certificate defines it, are proven; false once interrupted.
  [[nodiscard]] bool is_covered_by(const std::vector<bool>& cover, const Hook& interrupted = {}) const;

  [[nodiscard]] const Cell& whole() const { return whole_; }  ///< contains the neighbourhood
  /// Halves the cell across the first of its longest edges. Nothing for cells so small that the halves would not be
  /// exact in 127 bits.
  [[nodiscard]] std::optional<std::array<Cell, 2>> halves(const Cell& cell) const;
  /// Returns whether the part of the neighbourhood in the cell is proven to contain no point of the set.
  [[nodiscard]] bool is_empty(const Cell& cell) const;
  /// True if the cell's middle is proven to be on the other side than wanted. Then no division proves a cube, which
  /// contains all of its cells.
  [[nodiscard]] bool is_refuted_at_middle(const Cell& cell) const;

 private:
  struct Look;

  /// The hull of the corners, or the body about the only corner; other members are not set yet.
  EmptyNeighbourhood(const SetExpression& set, std::span<const PosedPrimitive> primitives,
                     std::span<const Point> corners, const ConvexBody* body, double radius, Place wanted);
  /// No smaller than v·x for any x of the point, triangle or body, from the centre.
  [[nodiscard]] Real reach(const PreciseVector& v) const;

  const SetExpression& set_;
  std::span<const PosedPrimitive> primitives_;
  PreciseVector centre_;
  std::vector<PreciseVector> corners_;  ///< the corners of the point or triangle, from the centre
  const ConvexBody* body_ = nullptr;    ///< the body in place of corners; null for a point or triangle
  Cell whole_;
  PreciseInterval square_of_radius_;
  Place wanted_;
  std::vector<Place> places_;  ///< the places of the whole neighbourhood relative to each primitive
  std::vector<std::optional<PreciseVector>> touching_;  ///< gradients at `near`: proposals only
};

}  // namespace verisq::verify
