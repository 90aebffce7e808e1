/// Points that two convex solids share, and projections between them.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "verisq/model.hpp"

namespace verisq::verify {

// Looks for a point that overlapping superquadrics share.

/// Somewhere in a frame: `rotation` and `offset` lead there from the solid's own frame, whose origin is its focus
/// (docs/mathematics.md §18).
struct PlacedSuperquadric {
  Superquadric solid;
  Eigen::Matrix3d rotation;
  Eigen::Vector3d offset;
};

/// A point with all gauges below 1, in plain floating point: it proposes and proves nothing. Uses the ellipsoid method,
/// which needs neither a start nor a well-shaped intersection. Nothing if the interiors do not meet, or meet in less
/// than about 1e-9 of the first solid's size. Precondition: at least one solid.
[[nodiscard]] std::optional<Eigen::Vector3d> common_point(std::span<const PlacedSuperquadric> solids);

/// The same for two solids, in A's frame; `rotation` and `offset` lead there from B's.
[[nodiscard]] std::optional<Eigen::Vector3d> common_point(const Superquadric& a, const Superquadric& b,
                                                          const Eigen::Matrix3d& rotation,
                                                          const Eigen::Vector3d& offset);

// Half the squared distance of a point to a superquadric in plain binary64, as a function to minimise.

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
/// It proves nothing, and converges less reliably than ContactProblem, but in a tenth of the time.
class PairProjection {
 public:
  explicit PairProjection(const Superquadric& solid);

  /// The expansion at a point of the solid's own frame.
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

// The closest points of two superquadrics by way of the midpoint between them, in plain binary64.

/// All in A's own frame but `on_b`, which is in B's.
struct MidpointContact {
  Eigen::Vector3d vector;  ///< from A to B, normal to both
  Eigen::Vector3d on_a;
  Eigen::Vector3d on_b;
};

/// Newton's method on half the squared distance to A plus half the squared distance to B, which is convex: at its
/// minimum the vectors from both solids cancel. Nothing if it does not converge, for example if the solids overlap.
/// `rotation` and `offset` lead from B's frame to A's.
[[nodiscard]] std::optional<MidpointContact> midpoint_contact(const Superquadric& a, const Superquadric& b,
                                                              const Eigen::Matrix3d& rotation,
                                                              const Eigen::Vector3d& offset,
                                                              const Eigen::Vector3d& start);

}  // namespace verisq::verify
