/// What the paper's method (§5.1) encloses of one superquadric in its own frame: a point of the surface, the normal
/// there, the support point of a direction; in double-ended interval arithmetic, as the paper does with FILIB++.
#pragma once

#include <optional>

#include "verify/proof/superquadric.hpp"
#include "verify/proposals/triangle.hpp"

namespace verisq::verify {

class BisectedEnclosure {
 public:
  explicit BisectedEnclosure(const Superquadric& superquadric);

  /// A box that contains a point of the surface {F = 1}, F being the left side of Eq. (1): the segment of the line
  /// p + t d between the t1 <= 0 with F <= 1 and the t2 >= 0 with F >= 1, both proven, that bisection finds closest to
  /// 0. Nothing if the line misses the solid.
  [[nodiscard]] std::optional<Vector3<double>> surface_point(const Coordinates<double>& p,
                                                             const Coordinates<double>& d) const;

  /// Contains, for each point of {F = 1} in the box, a positive multiple of a subgradient of F (of the gradient where
  /// there is one). Unbounded or with 0 where the formula divides by a coordinate that may vanish.
  [[nodiscard]] Vector3<double> normal(const Vector3<double>& x) const;

  /// Eqs. (14), (15), (5): contains, for each v of the bounded box but 0, a point of the solid where v·x is largest.
  [[nodiscard]] Vector3<double> support_point(const Vector3<double>& v) const;

  [[nodiscard]] const SuperquadricBounds<double>& bounds() const { return bounds_; }

 private:
  SuperquadricBounds<double> bounds_;
  Vector3<double> semi_axes_;
  Interval e1_, e2_;
  double reach_;  ///< at least the distance of any surface point from the centre
};

[[nodiscard]] bool bounded(const Vector3<double>& v);

/// The lower end of Eqs. (17) and (20), n·d / |n|, for some n of the box `normal` and some d of the box `to`; 0 where
/// that is not positive, or not bounded.
[[nodiscard]] double plane_distance(const Vector3<double>& normal, const Vector3<double>& to);

}  // namespace verisq::verify
