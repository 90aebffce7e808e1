/// Where on a part of a triangle the distance to a solid is least, and about which point a ball shows it: in plain
/// floating point, from what distances of single points tell. Proves nothing.
#pragma once

#include <array>
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

/// A ball about a point on the line of a look's direction, or near it, that holds the piece: the nearest centre whose
/// distance, where it grows along the line as fast as the way, proves that the piece is as far as `aim`.
struct ProvingBall {
  Point centre;
  double expected;  ///< the distance of the centre
  double reach;     ///< of the centre from the look
};

/// Nothing where no centre within `reach` would do.
[[nodiscard]] std::optional<ProvingBall> proving_ball(const TriangleFrame& frame, const Triangle& corners,
                                                      const Look& look, double aim, double reach);

}  // namespace verisq::verify
