/// Pieces of triangles, their areas, and distances proven on each.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "verisq/clearance.hpp"
#include "verisq/deviation.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/mesh.hpp"

namespace verisq::verify {

// Pieces of a triangle, made by dividing it at the middles of its sides, and what its vertices say of them.

/// The pieces at the first, the second, the third corner, and the middle one: together all of it. Corners to nearest.
[[nodiscard]] std::array<Triangle, 4> quarters(const Triangle& piece);

/// How far the corners of a piece, to nearest, are from the exact ones, at most, if it was made by no more than
/// `most_quarterings` divisions. Precondition: finite.
[[nodiscard]] double quartering_error(const Triangle& whole);

/// |a - b|, rounded up.
[[nodiscard]] double distance_in_binary64_up(const Point& a, const Point& b);

/// Of a function that changes by no more than the place does, and at the vertices is no less than `at_vertices`: no
/// less than this on all of the triangle. Precondition: no NaN.
[[nodiscard]] double least_on(const Triangle& whole, const std::array<double, 3>& at_vertices);

/// The same on all of a piece of it, whose corners are `off` at most.
[[nodiscard]] double least_on(const Triangle& piece, double off, const Triangle& whole,
                              const std::array<double, 3>& at_vertices);

// Mean and percentiles of a distance over cells of which only bounds are known (docs/mathematics.md §20).

/// On a triangle, with the affine function of these values at its corners: d, or d² where `squared`, is at least that
/// function + below and at most that + above.
struct AffineBounds {
  std::array<double, 3> values{};  ///< in ascending order: which corner is which does not matter
  double below = -infinity;
  double above = infinity;
  bool squared = false;
};

/// A part of what is weighed: all distances on it lie in `range`, their mean in `mean`.
struct WeightedCell {
  Enclosure weight;  ///< at least 0, finite
  Enclosure range;   ///< at least 0, as `mean`
  Enclosure mean;
  AffineBounds affine = {};  ///< of a triangle weighed by area
};

/// Which part of the cell's weight has distances of at most `distance`: enclosed, in [0, 1].
[[nodiscard]] Enclosure part_up_to(const WeightedCell& cell, double distance);

/// Of all cells together, by weight, whichever of its interval each is; where the total is not proven above 0, the hull
/// of all ranges. Precondition: at least one cell.
[[nodiscard]] Enclosure mean_of(std::span<const WeightedCell> cells);

/// Which part of all weight, whichever of its interval each is, has distances of at most `distance`: in [0, 1].
/// Precondition: at least one cell.
[[nodiscard]] Enclosure share_up_to(std::span<const WeightedCell> cells, double distance);

/// How much weight that is.
[[nodiscard]] Enclosure weight_up_to(std::span<const WeightedCell> cells, double distance);

/// Both, and all weight, as areas. Nothing but zeros of no cells.
[[nodiscard]] AreaWithin area_within(std::span<const WeightedCell> cells, double distance);

/// Chooses the widest of (width, index), until the others leave no more than a share of what is allowed; sorts them.
/// Nothing is proven by this.
void choose_widest(std::vector<std::pair<double, std::size_t>>& widths, double allowed, std::vector<bool>& chosen);

/// Sorts the ends once, for any number of percentiles. The cells must outlive it.
class Distribution {
 public:
  /// Precondition: at least one cell.
  explicit Distribution(std::span<const WeightedCell> cells);

  /// Of the least v such that the part of the weight with distances up to v is at least `percent`/100 of all. Where up
  /// to 12 decimals write `percent`, it is that decimal number: of 1000 equal weights 99.9 is the 999th.
  /// Precondition: 0 < percent <= 100.
  [[nodiscard]] Enclosure percentile(double percent) const;

 private:
  struct End {
    double distance;
    double weight;
  };

  /// Cells that may lie on either side of a distance between two others, and the weight of what lies below all these.
  struct Near {
    std::vector<const WeightedCell*> cells;
    Enclosure before{0.0, 0.0};
  };

  [[nodiscard]] static double first_at_least(std::span<const End> ends, double weight, bool up);
  [[nodiscard]] Near near(const Enclosure& bracket) const;
  [[nodiscard]] static Enclosure weight_up_to(const Near& near, double distance);
  [[nodiscard]] Enclosure narrowed(const Enclosure& percentile, const Enclosure& wanted) const;
  [[nodiscard]] Enclosure balance(double distance, const Enclosure& part) const;
  [[nodiscard]] Enclosure balanced(const Enclosure& percentile, const Enclosure& part) const;

  std::span<const WeightedCell> cells_;
  std::vector<End> lower_;  ///< sorted; with the largest weight that each may have
  std::vector<End> upper_;  ///< sorted; with the smallest
  Enclosure total_{0.0, 0.0};
};

// What distances at the corners and the centre of a piece of a triangle prove of all its points (docs/mathematics.md
// §20).

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

// What signed distances at points of a triangle, each of them proven, say of all of its points (docs/mathematics.md
// §20).

/// Who tells what of a model is proven.
struct SampleProofs {
  /// The signed distance at a point, whatever is claimed.
  std::function<Enclosure(const Point& x, const CertifiedEnclosure& claimed)> distance;
  /// Whether all of the model that is nearer to the point than `reach` is one convex primitive, by the normals of the
  /// certificate.
  std::function<bool(const Point& x, double reach, const Certificate& certificate)> is_one_convex;
  bool convex;  ///< the model is one convex primitive
};

[[nodiscard]] bool is_one_convex_primitive(const Model& model);

struct TriangleDistances {
  double largest = 0.0;             ///< no less than this, at a sample
  std::vector<WeightedCell> cells;  ///< distances to the surface, on all of its parts, by area
};

/// What the corners' signed distances tell of that of the centroid, which is 1-Lipschitz.
[[nodiscard]] Enclosure at_centre_by_corners(const TrianglePiece& piece, const PieceShape& shape);

/// How far the primitives are looked for that decide distances on a piece, from its centroid as it is rounded.
[[nodiscard]] double reach_of(const Enclosure& at_centre, const PieceShape& shape, double displacement);

/// A proof that is cut short, or has too few samples, says nothing of the whole triangle.
[[nodiscard]] TriangleDistances distances_on(const Triangle& triangle, const std::array<Enclosure, 3>& at_corners,
                                             const TriangleProof& proof, const SampleProofs& proofs);

}  // namespace verisq::verify
