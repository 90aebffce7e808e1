/// A posed primitive, tapered, bent or neither, in double: what the references of general models propose with.
#pragma once

#include <cstddef>
#include <verisq/model.hpp>

#include "tests/oracle/membership.hpp"
#include "tests/oracle/mixed_norm.hpp"

namespace verisq::oracle {

class PlacedPrimitive {
 public:
  explicit PlacedPrimitive(const Primitive& primitive);

  /// From the untapered, unbent, unposed frame to the model's, and back. Beyond the pole of the taper's inverse, which
  /// lies above or below the solid, nothing is untapered.
  [[nodiscard]] Point placed(const Point& local) const;
  [[nodiscard]] Point own(const Point& point) const;

  /// By the margin 1e-11 of the gauge, far above the rounding for solids of moderate proportions.
  [[nodiscard]] Membership membership(const Point& point) const;

  /// Of all points of the ball, by the margin 1e-10: first order in the radius, because the unbent coordinates x and y
  /// change at most by the radius, and z by the arc that the ball takes up as seen from the centre of curvature; the
  /// box of all these is untapered by its ends.
  [[nodiscard]] Membership membership(const Point& centre, double radius) const;

  [[nodiscard]] const MixedNorm<double>& norm() const { return norm_; }
  [[nodiscard]] const Primitive& primitive() const { return primitive_; }
  [[nodiscard]] const Point& centre() const { return primitive_.pose.translation; }

  /// The solid lies in the ball of this radius about `centre`: |z| along the arc, then across.
  [[nodiscard]] double reach() const;

 private:
  /// `scaled_radius` is |k| times the distance to the centre of curvature, 1 where k = 0.
  struct Unbent {
    Point local;
    double scaled_radius;
  };
  [[nodiscard]] Unbent unbent(const Point& point) const;
  [[nodiscard]] Point untapered(const Point& local) const;

  Primitive primitive_;
  MixedNorm<double> norm_;
  Triple<Point> rows_;  ///< of the rotation
  double taper_;        ///< (t - 1)/(t + 1)
  double curvature_ = 0.0;
  double cosine_ = 1.0;  ///< of the bend's angle
  double sine_ = 0.0;
};

}  // namespace verisq::oracle
