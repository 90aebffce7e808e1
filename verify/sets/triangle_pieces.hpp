/// Parts of one triangle, and what the signed distances of single points prove about theirs (docs/mathematics.md §6).
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "verify/proof/triangle_certificate.hpp"
#include "verisq/mesh.hpp"

namespace verisq::verify {

/// A part: the triangle of the three points that these weights give.
using Piece = std::array<Weights, 3>;

inline constexpr Piece whole_triangle{{{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}}};

/// Both halves, which cover the piece: the edge from corner `edge` to the next one is halved, exactly. Nothing where
/// binary64 has no place for the middle's weights.
[[nodiscard]] std::optional<std::array<Piece, 2>> halves(const Piece& piece, std::size_t edge);

/// The weights of a triangle's point next to these: no more digits than what halves take. Precondition: finite.
[[nodiscard]] Weights rounded_into_triangle(const Weights& weights);

/// Signed distances sd to any solid are continuous in the sense of Lipschitz: |sd(x) - sd(y)| <= |x - y|. The distance
/// of a piece to the solid is the least of max(0, sd) over its points.
class DividedTriangle {
 public:
  /// Precondition: finite corners.
  explicit DividedTriangle(const Triangle& triangle);

  /// The triangle's point of these weights, but for rounding, which the bounds below know of. Precondition:
  /// in_triangle(weights).
  [[nodiscard]] Point point(const Weights& weights) const;
  [[nodiscard]] Triangle corners(const Piece& piece) const;

  /// sd(x) >= sd(c) - |x - c| for all x of the piece with these `corners`, and |x - c| is largest at a corner: the
  /// least of sd over the piece, from `lo`, a lower bound of sd(c). Precondition: a finite `centre` c.
  [[nodiscard]] double lower_by_ball(const Triangle& corners, const Point& centre, double lo) const;

  /// Of the distance of the triangle, from `hi`, an upper bound of sd at `point(weights)`.
  [[nodiscard]] double upper_by_point(double hi) const;

 private:
  Triangle triangle_;
  double error_;  ///< no computed point is farther from the triangle's
};

}  // namespace verisq::verify
