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

// Pieces of a triangle, made by dividing it at the middles of its sides, and the bounds that its vertices give for
// them.

/// The pieces at the first, the second, the third corner, and the middle one: together all of the triangle. Corners are
/// rounded to nearest.
[[nodiscard]] std::array<Triangle, 4> quarters(const Triangle& piece);

/// Upper bound of the distance between the corners of a piece, rounded to nearest, and the exact corners, if the piece
/// was made by at most `most_quarterings` divisions. Precondition: finite.
[[nodiscard]] double quartering_error(const Triangle& whole);

/// |a - b|, rounded up.
[[nodiscard]] double distance_in_binary64_up(const Point& a, const Point& b);

/// Consider a 1-Lipschitz function of the place that is at least `at_vertices` at the vertices: it is at least this on
/// all of the triangle. Precondition: no NaN.
[[nodiscard]] double least_on(const Triangle& whole, const std::array<double, 3>& at_vertices);

/// The same on all of a piece of the triangle, whose corners are off by at most `off`.
[[nodiscard]] double least_on(const Triangle& piece, double off, const Triangle& whole,
                              const std::array<double, 3>& at_vertices);

// Mean and percentiles of a distance over cells with known bounds (docs/mathematics.md §20).

/// On a triangle, with the affine function of these values at its corners: d, or d² where `squared`, is at least that
/// function + below and at most that + above.
struct AffineBounds {
  std::array<double, 3> values{};  ///< in ascending order: which corner is which does not matter
  double below = -infinity;
  double above = infinity;
  bool squared = false;
};

/// A weighed part: all distances on it lie in `range`, their mean in `mean`.
struct WeightedCell {
  Enclosure weight;  ///< at least 0, finite
  Enclosure range;   ///< at least 0, as `mean`
  Enclosure mean;
  AffineBounds affine = {};  ///< for a triangle weighed by area
};

/// The share of the cell's weight with distances of at most `distance`: enclosed, in [0, 1].
[[nodiscard]] Enclosure part_up_to(const WeightedCell& cell, double distance);

/// The mean of all cells together, by weight, for any weights in their intervals. If the total weight is not proven to
/// be above 0: the hull of all ranges. Precondition: at least one cell.
[[nodiscard]] Enclosure mean_of(std::span<const WeightedCell> cells);

/// The share of all weight with distances of at most `distance`, for any weights in their intervals: in [0, 1].
/// Precondition: at least one cell.
/// Precondition: at least one cell.
[[nodiscard]] Enclosure share_up_to(std::span<const WeightedCell> cells, double distance);

/// The weight with distances of at most `distance`.
[[nodiscard]] Enclosure weight_up_to(std::span<const WeightedCell> cells, double distance);

/// The weight, the share and all weight, as areas. All are zero if there are no cells.
[[nodiscard]] AreaWithin area_within(std::span<const WeightedCell> cells, double distance);

/// Chooses the widest of (width, index), until the others have no more than a share of `allowed`; sorts them. The
/// choice proves nothing.
void choose_widest(std::vector<std::pair<double, std::size_t>>& widths, double allowed, std::vector<bool>& chosen);

/// Sorts the ends once, for any number of percentiles. The cells must outlive it.
class Distribution {
 public:
  /// Precondition: at least one cell.
  explicit Distribution(std::span<const WeightedCell> cells);

  /// The least v such that the part of the weight with distances up to v is at least `percent`/100 of all. A `percent`
  /// that up to 12 decimals write is that decimal number: the percentile 99.9 of 1000 equal weights is the 999th.
  /// Precondition: 0 < percent <= 100.
  [[nodiscard]] Enclosure percentile(double percent) const;

 private:
  struct End {
    double distance;
    double weight;
  };

  /// Cells that may lie on either side of a distance between two others, and the weight of all cells that lie below
  /// these.
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
  std::vector<End> lower_;  ///< sorted; each with its largest possible weight
  std::vector<End> upper_;  ///< sorted; each with its smallest possible weight
  Enclosure total_{0.0, 0.0};
};

// Bounds for all points of a piece of a triangle, by distances at its corners and its centre (docs/mathematics.md §20).

/// A part of a triangle, made by repeatedly halving at the middle of a side.
struct TrianglePiece {
  Triangle corners;  ///< rounded to nearest: off the exact corners by at most `displacement(triangle)`
  std::uint32_t triangle;
  std::uint8_t halvings = 0;  ///< its area is the triangle's area, halved so often
  /// On this piece the signed distance is the distance to one convex solid, hence a convex function.
  bool convex = false;
  std::array<Enclosure, 3> at_corners{};  ///< signed distance of the exact corners
  Enclosure at_centre{};                  ///< signed distance of their exact centroid
};

/// The largest number of halvings of a piece.
inline constexpr int most_halvings_of_piece = 60;

/// Upper bound of the distance of the corners and centre of any piece, rounded to nearest, from the exact ones.
[[nodiscard]] double displacement(const Triangle& whole);

/// The corners' mean, rounded to nearest.
[[nodiscard]] Point centre(const Triangle& corners);

/// The middle of the longest side, to nearest, and the two corners beside it, the first and the second of `halves`.
struct LongestSide {
  std::size_t from;
  std::size_t to;
  Point middle;
};
[[nodiscard]] LongestSide longest_side(const Triangle& corners);

/// Halves the piece at the middle of its longest side; `at_middle` is the signed distance there. The caller sets the
/// distances at the centres.
[[nodiscard]] std::array<TrianglePiece, 2> halves(const TrianglePiece& piece, const LongestSide& side,
                                                  const Enclosure& at_middle);

/// The area of the triangle with exactly these corners.
[[nodiscard]] Enclosure area_of(const Triangle& triangle);

/// Upper bounds of the sizes of an exact piece; all are infinite if squares may overflow.
struct PieceShape {
  double longest;  ///< side
  double radius;   ///< radius of a ball about the centroid that contains the piece
  double radius_squared;
  double moment;  ///< the mean of |x - centroid|² over the piece: (a² + b² + c²)/36
  double spread;  ///< the root of `moment`: no less than the mean of |x - centroid|
};

[[nodiscard]] PieceShape shape_of(const Triangle& corners, double displacement);

/// The unsigned distance to the boundary of the solid, over the exact piece.
struct PieceDistances {
  Enclosure range;  ///< contains all of them
  Enclosure mean;   ///< contains their mean by area
  AffineBounds affine = {};
};
[[nodiscard]] PieceDistances distances_on(const TrianglePiece& piece, const PieceShape& shape);

/// The distance at a point that is off by at most `displacement`, from the signed distance at the other point.
[[nodiscard]] Enclosure widened(const Enclosure& distance, double displacement);

/// The enclosure of |x| for x in the enclosure.
[[nodiscard]] Enclosure magnitude(const Enclosure& signed_distance);

// Bounds for all points of a triangle, by proven signed distances at some of its points (docs/mathematics.md §20).

/// Proves the facts about a model that samples need.
struct SampleProofs {
  /// The proven signed distance at a point, whatever is claimed.
  std::function<Enclosure(const Point& x, const CertifiedEnclosure& claimed)> distance;
  /// Returns whether the whole part of the model that is nearer to the point than `reach` is proven to be one convex
  /// primitive, by the normals of the certificate.
  std::function<bool(const Point& x, double reach, const Certificate& certificate)> is_one_convex;
  bool convex;  ///< the model is one convex primitive
};

[[nodiscard]] bool is_one_convex_primitive(const Model& model);

struct TriangleDistances {
  double largest = 0.0;             ///< at some sample the distance is no less than this
  std::vector<WeightedCell> cells;  ///< distances to the surface, on all of its parts, by area
};

/// The centroid's signed distance, enclosed by the corners' signed distances: the signed distance is 1-Lipschitz.
[[nodiscard]] Enclosure at_centre_by_corners(const TrianglePiece& piece, const PieceShape& shape);

/// The radius about the rounded centroid within which primitives decide the distances on a piece.
[[nodiscard]] double reach_of(const Enclosure& at_centre, const PieceShape& shape, double displacement);

/// A proof that is cut short, or has too few samples, proves nothing about the whole triangle.
[[nodiscard]] TriangleDistances distances_on(const Triangle& triangle, const std::array<Enclosure, 3>& at_corners,
                                             const TriangleProof& proof, const SampleProofs& proofs);

}  // namespace verisq::verify
