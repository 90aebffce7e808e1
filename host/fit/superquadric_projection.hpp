/// The signed distance of a point to one superquadric in plain binary64, as searches for poses need it.
#pragma once

#include <Eigen/Core>

#include "verify/proposals/boundary.hpp"
#include "verify/search/pair_projection.hpp"
#include "verisq/model.hpp"

namespace verisq::fit_search {

/// In the solid's own frame. The distance changes with the point along `normal`, a unit vector, and with semi-axis i by
/// -normal[i] * nearest[i] / a[i]: sd(q) = max over |v| = 1 of v·q - h(v), and h depends on the products a[i] v[i]
/// only.
struct Projection {
  double distance;  ///< negative inside
  Eigen::Vector3d normal;
  Eigen::Vector3d nearest;  ///< the closest point of the surface
};

/// Derivatives of a distance by the semi-axes, as above.
[[nodiscard]] inline Eigen::Vector3d size_gradient(const Eigen::Vector3d& normal, const Eigen::Vector3d& nearest,
                                                   const Superquadric& solid) {
  const auto& [a, b, c] = solid.semi_axes;
  return -normal.cwiseProduct(nearest).cwiseQuotient(Eigen::Vector3d(a, b, c));
}

/// Outside by Newton's method on the optimality conditions; inside by walking along the normal of the surface where the
/// last walk ended, which never lengthens the way and stops at a locally shortest one. Where Newton's method does not
/// converge, the host's proof takes its place. Proves nothing.
class SuperquadricProjection {
 public:
  explicit SuperquadricProjection(const Superquadric& solid);

  [[nodiscard]] Projection operator()(const Eigen::Vector3d& q) const;

  /// Not more than the signed distance: that to the solid's box.
  [[nodiscard]] double lower_bound(const Eigen::Vector3d& q) const;

 private:
  [[nodiscard]] Projection proven(const Eigen::Vector3d& q) const;
  [[nodiscard]] Projection from_inside(const Eigen::Vector3d& q) const;

  Superquadric solid_;
  verify::PairProjection outside_;
  verify::Boundary<double> boundary_;
};

}  // namespace verisq::fit_search
