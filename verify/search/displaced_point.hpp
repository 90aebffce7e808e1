/// The places of a point as seen by a model whose pose is known within bounds (docs/mathematics.md §27).
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "verify/numbers/interval.hpp"
#include "verify/numbers/vector.hpp"
#include "verisq/map.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// The places E⁻¹(p) of a point p, E any of the uncertain motions.
class DisplacedPoint {
 public:
  /// Precondition: everything is finite, bounds are at least 0.
  DisplacedPoint(const PoseUncertainty& bounds, const Point& point);

  /// No place is farther from the point than this: rounded up.
  [[nodiscard]] double reach() const { return reach_; }

  /// Half the edges of a box about the point that contains all places: rounded up.
  [[nodiscard]] const std::array<double, 3>& half_extent() const { return half_extent_; }

  /// Returns whether it is proven that no place is within `radius` of `centre`.
  [[nodiscard]] bool avoids(const Point& centre, double radius) const;

  /// n·y is at most this for every place point + y, and every n of the box: rounded up.
  [[nodiscard]] double support(const Vector3<double>& n) const;

  static constexpr std::size_t cover_size = std::size_t{8} * 12;
  /// Adds that many points; every place lies within `cover_error` of their convex hull.
  void append_cover(std::vector<Point>& points) const;
  [[nodiscard]] double cover_error() const;

 private:
  [[nodiscard]] bool separates(const Vector3<double>& n, const Vector3<double>& from_point, double radius) const;

  Vector3<double> point_;
  std::array<double, 3> translation_;
  Vector3<double> arm_;  ///< from the centre to the point
  Interval turn_;        ///< κ
  Interval arm_length_;
  Interval shift_length_;  ///< length of the longest translation
  double reach_;
  std::array<double, 3> half_extent_{};
};

/// The farthest that the motions take any point of the box about a model, itself or seen from it: rounded up.
[[nodiscard]] double reach_of(const PoseUncertainty& bounds, const Model& model);

}  // namespace verisq::verify
