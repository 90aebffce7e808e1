/// The signed distance of a point to one tapered superquadric in plain binary64, as searches for poses need it.
#pragma once

#include <Eigen/Core>

#include "host/fit/superquadric_projection.hpp"
#include "host/fit/tapered_newton.hpp"
#include "verisq/model.hpp"

namespace verisq::fit_search {

/// As SuperquadricProjection, of a tapered solid (docs/mathematics.md §18): by tangent planes that come ever nearer to
/// the point, as kernels/tapered_distance_gradient.clh has them. Where they do not lead to the closest point of one
/// outside, the host's search for contacts takes their place; inside they stop at a locally shortest way. Proves
/// nothing.
class TaperedProjection {
 public:
  explicit TaperedProjection(const Superquadric& solid);

  /// The size's derivatives are as of an untapered solid: the taper scales as the semi-axes do.
  [[nodiscard]] Projection operator()(const Eigen::Vector3d& q) const;

  /// Not more than the signed distance: that to a box.
  [[nodiscard]] double lower_bound(const Eigen::Vector3d& q) const;

 private:
  struct Plane;
  struct BoundaryPlane;

  [[nodiscard]] Plane plane(const Eigen::Vector3d& v, const Eigen::Vector3d& q) const;
  [[nodiscard]] Plane nearest_end_or_wall(const Eigen::Vector3d& q) const;
  [[nodiscard]] BoundaryPlane plane_through(const Eigen::Vector3d& x, const Eigen::Vector3d& q) const;
  [[nodiscard]] Eigen::Vector3d newton_step(const BoundaryPlane& at, const Eigen::Vector3d& q) const;
  [[nodiscard]] BoundaryPlane nearest_plane(const Plane& first, const Eigen::Vector3d& q) const;
  [[nodiscard]] bool closest(const BoundaryPlane& at, const Eigen::Vector3d& q) const;
  [[nodiscard]] static Projection projection(const Plane& plane, const Eigen::Vector3d& p);
  [[nodiscard]] Projection by_contact(const Eigen::Vector3d& q) const;

  Superquadric solid_;
  Eigen::Array3d axes_;
  double p1_, p2_;
  double k_, fall_;  ///< k, 1 - k²
  TaperedNewton newton_;
};

}  // namespace verisq::fit_search
