/// Proves that a ball about a point holds nothing of a set, by a cover of cells each of which is settled on its own.
#pragma once

#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "verify/proof/posed_bent.hpp"
#include "verify/proof/posed_superquadric.hpp"
#include "verisq/certificate.hpp"

namespace verisq::verify {

using PosedPrimitive = std::variant<PosedSuperquadric, PosedBent>;

/// Where a region lies with respect to a set: it has no point of it, or lies in its interior.
enum class Place : std::int8_t { outside = -1, undecided = 0, inside = 1 };

/// Of a point. Precondition: finite.
[[nodiscard]] Place place_of(const Point& x, const SetExpression& set, std::span<const PosedPrimitive> primitives);

/// The open ball of `radius` about `centre`, of which is asked whether it holds a point of the set or, with
/// Place::inside, of the closure of the set's complement (docs/mathematics.md §28).
class EmptyBall {
 public:
  /// A part of the cube about the ball, relative to its centre: exact, halved `depth` times.
  struct Cell {
    std::array<Real, 3> offset, half;
    int depth = 0;
  };
  static constexpr int deepest = 150;                      ///< cells so deep are exact in 127 bits
  static constexpr std::size_t longest_cover = 1U << 16U;  ///< a checker's work is bounded

  /// Each of the normals may tell on which side of its primitive the whole ball lies; `near`, a point beside the
  /// nearest of the set, which half-spaces serve. Keeps references to the set and its primitives. Precondition: finite,
  /// radius > 0; normals of primitives that exist.
  EmptyBall(const SetExpression& set, std::span<const PosedPrimitive> primitives, const Point& centre, double radius,
            Place wanted, std::span<const Normal> normals, const std::optional<Point>& near);

  /// Whether the cells of the cover, as Certificate states it, are all proven.
  [[nodiscard]] bool is_covered_by(const std::vector<bool>& cover) const;

  [[nodiscard]] Cell whole() const { return {{}, {radius_, radius_, radius_}}; }
  [[nodiscard]] static std::array<Cell, 2> halves(const Cell& cell);  ///< across x, y, z in turn
  /// Whether the part of the ball in the cell is proven to hold nothing of the set.
  [[nodiscard]] bool is_empty(const Cell& cell) const;

 private:
  struct Look;

  const SetExpression& set_;
  std::span<const PosedPrimitive> primitives_;
  PreciseVector centre_;
  PreciseInterval square_of_radius_;
  Real radius_;
  Place wanted_;
  std::vector<Place> places_;                           ///< of the whole ball
  std::vector<std::optional<PreciseVector>> touching_;  ///< gradients at `near`: nothing is proven of them
};

}  // namespace verisq::verify
