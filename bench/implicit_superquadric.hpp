/// Eq. (1) with its first and second derivatives in plain floating point, as optimisers want it.
#pragma once

#include <Eigen/Core>
#include <verisq/model.hpp>

namespace verisq::bench {

/// F(x) = ((x/a1)^(2/e2) + (y/a2)^(2/e2))^(e2/e1) + (z/a3)^(2/e1); the solid is F <= 1.
class ImplicitSuperquadric {
 public:
  explicit ImplicitSuperquadric(const Superquadric& solid);

  [[nodiscard]] double value(const Eigen::Vector3d& x) const;
  [[nodiscard]] Eigen::Vector3d gradient(const Eigen::Vector3d& x) const;

  /// Where an exponent e is above 1 second derivatives grow without bound towards a coordinate plane: they are taken no
  /// nearer to it than 1e-8 semi-axes.
  [[nodiscard]] Eigen::Matrix3d hessian(const Eigen::Vector3d& x) const;

  /// On the ray from the centre towards `direction`, half way to the surface, but off the coordinate planes, where
  /// derivatives may not exist, by at least a hundredth of the semi-axes. Precondition: direction not zero.
  [[nodiscard]] Eigen::Vector3d interior_point(const Eigen::Vector3d& direction) const;

 private:
  Superquadric solid_;
  double section_power_;  // 2/e2
  double profile_power_;  // 2/e1
};

}  // namespace verisq::bench
