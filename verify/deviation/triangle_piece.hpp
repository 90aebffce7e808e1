/// What distances at the corners and the centre of a piece of a triangle prove of all its points (docs/mathematics.md
/// §20).
#pragma once

#include <array>
#include <cstdint>

#include "verify/deviation/weighted_cells.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/mesh.hpp"

namespace verisq::verify {

/// A part of a triangle that is made by halving its pieces at the middle of a side.
struct TrianglePiece {
  Triangle corners;  ///< to nearest: off the exact ones by at most `displacement(triangle)`
  std::uint32_t triangle;
  std::uint8_t halvings = 0;  ///< its area is that of the triangle, halved so often
  /// On this piece the signed distance is that to one convex solid, hence a convex function.
  bool convex = false;
  std::array<Enclosure, 3> at_corners{};  ///< signed distance of the exact corners
  Enclosure at_centre{};                  ///< and of their exact centroid
};

/// No piece is halved more often.
inline constexpr int most_halvings_of_piece = 60;

/// How far corners and centre of any piece, to nearest, lie from the exact ones, at most.
[[nodiscard]] double displacement(const Triangle& whole);

/// The corners' mean, to nearest.
[[nodiscard]] Point centre(const Triangle& corners);

/// The middle of the longest side, to nearest, and the two corners beside it, the first and the second of `halves`.
struct LongestSide {
  std::size_t from;
  std::size_t to;
  Point middle;
};
[[nodiscard]] LongestSide longest_side(const Triangle& corners);

/// At that middle, whose signed distance is given; those at the centres are left to the caller.
[[nodiscard]] std::array<TrianglePiece, 2> halves(const TrianglePiece& piece, const LongestSide& side,
                                                  const Enclosure& at_middle);

/// Of exactly these corners.
[[nodiscard]] Enclosure area_of(const Triangle& triangle);

/// Sizes of an exact piece, from above; all infinite where squares may overflow.
struct PieceShape {
  double longest;  ///< side
  double radius;   ///< of a ball about the centroid that holds the piece
  double radius_squared;
  double moment;  ///< the mean of |x - centroid|² over the piece: (a² + b² + c²)/36
  double spread;  ///< its root: no less than the mean of |x - centroid|
};

[[nodiscard]] PieceShape shape_of(const Triangle& corners, double displacement);

/// Of the distance to the boundary of the solid, which is not signed, over the exact piece.
struct PieceDistances {
  Enclosure range;  ///< contains all of them
  Enclosure mean;   ///< contains their mean by area
  AffineBounds affine = {};
};
[[nodiscard]] PieceDistances distances_on(const TrianglePiece& piece, const PieceShape& shape);

/// By how much a signed distance at a point that is off by `displacement` differs, at most.
[[nodiscard]] Enclosure widened(const Enclosure& distance, double displacement);

/// Of |x| for x in the enclosure.
[[nodiscard]] Enclosure magnitude(const Enclosure& signed_distance);

}  // namespace verisq::verify
