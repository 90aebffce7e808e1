/// Half the squared distance of a point to a superquadric in plain binary64, as a function to minimise.
#pragma once

#include <Eigen/Core>

#include "verisq/model.hpp"

namespace verisq::verify {

/// Logarithms of |coordinates| in units of the semi-axes, of the radius r of their section and of the multiplier λ.
struct LogUnknowns {
  Eigen::Array3d coordinates;
  double r;
  double lambda;
};

/// Convex; the gradient is the vector from the closest point, the Hessian lies between 0 and the identity.
struct DistanceExpansion {
  double value;              ///< 0 inside, infinite where the projection did not converge
  Eigen::Vector3d gradient;  ///< 0 inside; every component accurate relative to itself
  Eigen::Matrix3d hessian;
  bool inside;
  LogUnknowns closest;
};

/// Newton's method on the optimality conditions of docs/mathematics.md §3, in logarithms:
///     X + (λ r^(p1 - p2) / a1^2) X^(p2 - 1) = |q1| / a1,   Y alike,   Z + (λ / a3^2) Z^(p1 - 1) = |q3| / a3,
///     r = ‖(X, Y)‖_p2,   ‖(r, Z)‖_p1 = 1.
/// It proves nothing, and converges less surely than ContactProblem but in a tenth of the time.
class PairProjection {
 public:
  explicit PairProjection(const Superquadric& solid);

  /// At a point of the solid's own frame.
  [[nodiscard]] DistanceExpansion operator()(const Eigen::Vector3d& q) const;
  /// Starts from the closest point of a point nearby.
  [[nodiscard]] DistanceExpansion operator()(const Eigen::Vector3d& q, const LogUnknowns& start) const;

 private:
  struct Equations;
  struct Step;
  struct OutsideLogarithms;

  [[nodiscard]] double log_gauge(const Eigen::Array3d& log_x) const;
  [[nodiscard]] OutsideLogarithms outside_logarithms(const Eigen::Vector3d& q) const;
  [[nodiscard]] LogUnknowns radial_start(const Eigen::Array3d& log_x) const;
  [[nodiscard]] Equations equations_at(const LogUnknowns& u) const;
  [[nodiscard]] Step solve(const Equations& e, const Eigen::Array3d& of_coordinates, double of_section,
                           double of_surface) const;
  [[nodiscard]] DistanceExpansion expand(const Eigen::Vector3d& q, const OutsideLogarithms& at,
                                         const LogUnknowns& start) const;

  Eigen::Array3d axes_;
  Eigen::Array3d log_axes_;
  double p1_, p2_;
  Eigen::Array3d p_;  ///< p2, p2, p1
};

}  // namespace verisq::verify
