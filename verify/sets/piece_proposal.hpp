/// Where on a part of a triangle the distance to a solid is least, and which ball shows it: in plain floating point,
/// from what distances of single points tell. Proves nothing.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "verify/sets/triangle_pieces.hpp"

namespace verisq::verify {

/// What is known about the distance near a point of the triangle.
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

  /// From distances at a point and at its probes; nothing where these tell no direction.
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
  /// That of the distance of a sphere of this radius, about its centre.
  explicit Curvature(double radius) : rows_{{{1.0 / radius, 0.0}, {0.0, 1.0 / radius}}} {}

  void learn(const TriangleFrame& frame, const Look& from, const Look& to);

  [[nodiscard]] TriangleFrame::InPlane times(const TriangleFrame::InPlane& v) const;
  [[nodiscard]] double determinant() const { return rows_[0][0] * rows_[1][1] - rows_[0][1] * rows_[1][0]; }

 private:
  std::array<TriangleFrame::InPlane, 2> rows_;
};

struct LeastPoint {
  Weights weights;  ///< of the triangle
  double gain;      ///< by how much the distance there is below that of the look
};

/// The least point of the piece, of a quadratic model of the distance about a look.
[[nodiscard]] LeastPoint least_point(const TriangleFrame& frame, const Piece& piece, const Triangle& corners,
                                     const Look& about, const Curvature& curvature);

/// Directions in which the piece may be proven to be as far as `aim`: those beyond a plane orthogonal to which, through
/// the point of the solid that the look's direction comes from, all of it is. The look's own; and where the least point
/// lies within an edge or the face, those that are orthogonal to it.
struct ProvingDirections {
  std::array<Point, 5> directions;
  std::size_t count;
};
[[nodiscard]] ProvingDirections proving_directions(const TriangleFrame& frame, const Triangle& corners,
                                                   const Look& look, double aim);

/// A ball that holds the piece, its centre beyond a look.
struct ProvingBall {
  Point centre;
  double reach;  ///< of the centre from the look
};

/// The smallest one that proves that the piece is as far as `aim` if the distance grows along the direction as fast as
/// the way. Nothing where no centre within `reach` would do.
[[nodiscard]] std::optional<ProvingBall> proving_ball(const Triangle& corners, const Look& look, const Point& direction,
                                                      double aim, double reach);

}  // namespace verisq::verify
