/// A closed surface in cubes: which part of a cube lies on its bone's side, where that is simple (docs/mathematics.md
/// §23).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "verify/numbers/vector.hpp"
#include "verify/proof/closed_surface.hpp"
#include "verify/proof/volume_in_cube.hpp"
#include "verify/solids/cube.hpp"
#include "verisq/clearance.hpp"

namespace verisq::verify {

/// Immutable: safe to ask from many threads.
class BoundingSurface {
 public:
  /// Closes the surface over its rims. Throws Error(input) unless it is finite and every edge of the closed surface is
  /// run through as often one way as the other. Also throws unless it encloses a volume that is proven not to be 0.
  /// Precondition: triangles of existing vertices.
  explicit BoundingSurface(const BoneSurface& surface) : BoundingSurface(surface, closing_over_rims(surface.mesh)) {}

  [[nodiscard]] std::size_t rims() const { return rims_; }
  [[nodiscard]] const ClosedSurface& closed() const { return surface_; }

  /// The facts known about a cube.
  struct Piece {
    std::vector<std::uint32_t> triangles;  ///< a point in the cube
    Point place{};                         ///< the winding number at `place`
    std::optional<int> winding = {};       ///< there
  };

  [[nodiscard]] Piece piece(const Cube& cube) const;
  /// The piece of a cube within the cube of `whole`: the same result, at less cost.
  [[nodiscard]] Piece piece(const Cube& cube, const Piece& whole) const;

  /// Returns whether no bone lies in the cube, on this side of this surface.
  [[nodiscard]] bool leaves_nothing(const Piece& piece) const;

  /// Adds the restriction that points are on the bone's side.
  void restrict(BracketedPart& part, const Cube& cube, const Piece& piece) const;

 private:
  enum class Answer : std::uint8_t { no, yes, unknown };
  struct Wedge;

  BoundingSurface(const BoneSurface& surface, const Closing& closing);

  [[nodiscard]] Piece piece(const Cube& cube, const std::vector<std::uint32_t>& of, const Piece* whole) const;
  [[nodiscard]] Answer is_bone(int winding) const;
  void restrict_to_side(BracketedPart& part, int winding_behind, const Wedge& wedge) const;
  void restrict_by_one(BracketedPart& part, const Cube& cube, const Piece& piece) const;
  void restrict_by_two(BracketedPart& part, const Cube& cube, const Piece& piece) const;

  std::size_t rims_;
  ClosedSurface surface_;
  BoneSide side_;
  int orientation_;  ///< the sign of the volume that it encloses
};

/// The values at a cube's corners of the function (x - point)·normal.
[[nodiscard]] CornerHeights heights_above(const Cube& cube, const Point& point, const Vector3<double>& normal);

}  // namespace verisq::verify
