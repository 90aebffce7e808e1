/// Proves that a neighbourhood of a point, triangle or convex body holds nothing of a set, by a cover of cells each of
/// which is settled on its own.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "verify/proof/triangle_certificate.hpp"
#include "verisq/checker.hpp"
#include "verisq/mesh.hpp"

namespace verisq::verify {

/// Where a region lies with respect to a set: it has no point of it, or lies in its interior.
enum class Place : std::int8_t { outside = -1, undecided = 0, inside = 1 };

/// Of a point that lies in the box. Precondition: finite.
[[nodiscard]] Place place_of(const PreciseVector& x, const SetExpression& set,
                             std::span<const PosedPrimitive> primitives);

/// A region of which a support function is at hand. All vectors are from a point beside it, its centre.
class ConvexBody {
 public:
  ConvexBody() = default;
  ConvexBody(const ConvexBody&) = default;
  ConvexBody& operator=(const ConvexBody&) = default;
  virtual ~ConvexBody() = default;

  /// No smaller than v·x of any point x.
  [[nodiscard]] virtual Real reach(const PreciseVector& v) const = 0;
  /// About the point that is farthest along v: proves nothing.
  [[nodiscard]] virtual std::array<double, 3> farthest(const std::array<double, 3>& v) const = 0;
};

/// What of the points nearer than `radius` to a point, triangle or convex body lies in a cell: asked is whether it
/// holds a point of the set or, with Place::inside, of the closure of the set's complement (docs/mathematics.md §28).
class EmptyNeighbourhood {
 public:
  /// A box relative to `centre()`: exact.
  struct Cell {
    std::array<Real, 3> offset, half;
  };
  static constexpr std::size_t longest_cover = 1U << 16U;  ///< a checker's work is bounded

  /// Each of the normals may tell on which side of its primitive the whole neighbourhood lies; `near`, a point beside
  /// the nearest of the set, which half-spaces serve. Once `interrupted`, polled unless empty, says so, the normals
  /// tell no more. Keeps references to the set and its primitives. Precondition: finite, radius > 0; normals of
  /// primitives that exist; of a triangle Place::outside is wanted.
  template <class PointOrTriangle>
  EmptyNeighbourhood(const SetExpression& set, std::span<const PosedPrimitive> primitives, const PointOrTriangle& query,
                     double radius, Place wanted, std::span<const Normal> normals, const std::optional<Point>& near,
                     const Hook& interrupted = {});

  /// Of a body about `centre`; it is kept, too. Place::outside is wanted.
  EmptyNeighbourhood(const SetExpression& set, std::span<const PosedPrimitive> primitives, const ConvexBody& body,
                     const Point& centre, double radius);

  /// Of a cube about any point of the box `centre`, all of it: its neighbourhood is a ball that contains it.
  EmptyNeighbourhood(const SetExpression& set, std::span<const PosedPrimitive> primitives, const PreciseVector& centre,
                     const Real& half_width, Place wanted);

  /// Whether the cells of the cover, as Certificate states it, are all proven; false once interrupted.
  [[nodiscard]] bool is_covered_by(const std::vector<bool>& cover, const Hook& interrupted = {}) const;

  [[nodiscard]] const Cell& whole() const { return whole_; }  ///< contains the neighbourhood
  /// Across the first of its longest edges; nothing of cells so small that the halves would not be exact in 127 bits.
  [[nodiscard]] std::optional<std::array<Cell, 2>> halves(const Cell& cell) const;
  /// Whether the part of the neighbourhood in the cell is proven to hold nothing of the set.
  [[nodiscard]] bool is_empty(const Cell& cell) const;
  /// True where the cell's middle is proven to be on the other side than wanted. Then no division proves a cube, which
  /// holds all of its cells.
  [[nodiscard]] bool is_refuted_at_middle(const Cell& cell) const;

 private:
  struct Look;

  /// Of the hull of the corners, or of the body about the only one; the rest is not known yet.
  EmptyNeighbourhood(const SetExpression& set, std::span<const PosedPrimitive> primitives,
                     std::span<const Point> corners, const ConvexBody* body, double radius, Place wanted);
  /// No smaller than v·x of any x of point, triangle or body, from the centre.
  [[nodiscard]] Real reach(const PreciseVector& v) const;

  const SetExpression& set_;
  std::span<const PosedPrimitive> primitives_;
  PreciseVector centre_;
  std::vector<PreciseVector> corners_;  ///< of point or triangle, from the centre
  const ConvexBody* body_ = nullptr;    ///< in their place; nothing of point or triangle
  Cell whole_;
  PreciseInterval square_of_radius_;
  Place wanted_;
  std::vector<Place> places_;                           ///< of the whole neighbourhood
  std::vector<std::optional<PreciseVector>> touching_;  ///< gradients at `near`: nothing is proven of them
};

}  // namespace verisq::verify
