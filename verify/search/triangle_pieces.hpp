/// Pieces of triangles, and proposals of distances on each.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "verify/proof/posed_superquadric.hpp"
#include "verisq/mesh.hpp"

namespace verisq::verify {

// Parts of one triangle, and bounds of their distances from the signed distances of single points (docs/mathematics.md
// §6).

/// A part of the triangle: the triangle of the three points with these weights.
using Piece = std::array<Weights, 3>;

inline constexpr Piece whole_triangle{{{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}}};

/// Both halves, which cover the piece: the edge from corner `edge` to the next one is halved, exactly. Nothing if
/// binary64 cannot represent the middle's weights.
[[nodiscard]] std::optional<std::array<Piece, 2>> halves(const Piece& piece, std::size_t edge);

/// The weights of a point of the triangle next to these: they have no more digits than those of halves. Precondition:
/// finite.
[[nodiscard]] Weights rounded_into_triangle(const Weights& weights);

/// Signed distances sd to any solid are continuous in the sense of Lipschitz: |sd(x) - sd(y)| <= |x - y|. The distance
/// of a piece to the solid is the least of max(0, sd) over its points.
class DividedTriangle {
 public:
  /// The corners may be off by `lost` each. Precondition: finite corners.
  explicit DividedTriangle(const Triangle& triangle, double lost = 0.0);

  /// The triangle's point with these weights, but for rounding, which the bounds below include. Precondition:
  /// in_triangle(weights).
  [[nodiscard]] Point point(const Weights& weights) const;
  [[nodiscard]] Triangle corners(const Piece& piece) const;

  /// sd(x) >= sd(c) - |x - c| for all x of the piece with these `corners`, and |x - c| is largest at a corner: the
  /// least of sd over the piece, from `lo`, a lower bound of sd(c). Precondition: a finite `centre` c.
  [[nodiscard]] double lower_by_ball(const Triangle& corners, const Point& centre, double lo) const;

  /// An upper bound of the distance of the triangle, from `hi`, an upper bound of sd at `point(weights)`.
  [[nodiscard]] double upper_by_point(double hi) const;

 private:
  Triangle triangle_;
  double error_;  ///< no computed point is farther from the triangle's exact point
};

// The point of a part of a triangle with the least distance to a solid, and the ball that proves a bound. In plain
// floating point, from the distances of single points. Proves nothing.

/// The known distance near a point of the triangle.
struct Look {
  Point at;
  double distance;
  Point direction;  ///< the gradient of the signed distance, a unit vector: away from the solid
};

/// Orthonormal; the first two span the triangle's plane, where it has one.
class TriangleFrame {
 public:
  explicit TriangleFrame(const Triangle& triangle);

  /// Three points about `at`, a step along each axis.
  [[nodiscard]] Triangle probes(const Point& at, double step) const;

  /// The direction from distances at a point and at its probes; nothing if these determine no direction.
  [[nodiscard]] std::optional<Point> direction(double at, const std::array<double, 3>& at_probes, double step) const;

  using InPlane = std::array<double, 2>;

  /// Coordinates in the plane from the first corner.
  [[nodiscard]] InPlane place(const Point& x) const;
  [[nodiscard]] InPlane part_in_plane(const Point& direction) const;
  [[nodiscard]] const Point& normal() const { return axes_[2]; }

 private:
  Point origin_;
  std::array<Point, 3> axes_;
};

/// The second derivatives of the distance in the triangle's plane, learned from looks (the update of Broyden, Fletcher,
/// Goldfarb and Shanno); always positive definite.
class Curvature {
 public:
  /// The curvature of the distance of a sphere of this radius, about its centre.
  explicit Curvature(double radius) : rows_{{{1.0 / radius, 0.0}, {0.0, 1.0 / radius}}} {}

  void learn(const TriangleFrame& frame, const Look& from, const Look& to);

  [[nodiscard]] TriangleFrame::InPlane times(const TriangleFrame::InPlane& v) const;
  [[nodiscard]] double determinant() const { return rows_[0][0] * rows_[1][1] - rows_[0][1] * rows_[1][0]; }

 private:
  std::array<TriangleFrame::InPlane, 2> rows_;
};

struct LeastPoint {
  Weights weights;  ///< weights in the triangle
  double gain;      ///< by how much the distance there is below that of the look
};

/// The least point of the piece, of a quadratic model of the distance about a look.
[[nodiscard]] LeastPoint least_point(const TriangleFrame& frame, const Piece& piece, const Triangle& corners,
                                     const Look& about, const Curvature& curvature);

/// Directions along which the piece may be proven to be as far as `aim`. Take the plane orthogonal to the direction
/// through the point of the solid from which the look's direction comes: all of the piece lies beyond it. The
/// directions are the look's own and, if the least point lies within an edge or the face, those orthogonal to it.
struct ProvingDirections {
  std::array<Point, 5> directions;
  std::size_t count;
};
[[nodiscard]] ProvingDirections proving_directions(const TriangleFrame& frame, const Triangle& corners,
                                                   const Look& look, double aim);

/// A ball that contains the piece, its centre beyond a look.
struct ProvingBall {
  Point centre;
  double reach;  ///< distance of the centre from the look
};

/// The smallest ball that proves that the piece is as far as `aim`, if the distance grows along the direction as fast
/// as the way. Nothing if no centre within `reach` is suitable.
[[nodiscard]] std::optional<ProvingBall> proving_ball(const Triangle& corners, const Look& look, const Point& direction,
                                                      double aim, double reach);

}  // namespace verisq::verify
