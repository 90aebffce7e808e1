/// The point of a tapered superquadric closest to a point outside: Newton's method in logarithms.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "verisq/model.hpp"

namespace verisq::fit_search {

/// Solves in binary64 what kernels/tapered_proposal.clh solves in binary32, the optimality conditions of
/// docs/mathematics.md §18. About the focus the closest point is M u with u on the untapered surface.
class TaperedNewton {
 public:
  /// Precondition: exponents below 2.
  explicit TaperedNewton(const Superquadric& solid);

  /// u for q = (q_x >= 0, q_y >= 0, q_z) about the focus; nothing where Newton's method does not converge. Proves
  /// nothing. Precondition: q is outside.
  [[nodiscard]] std::optional<Eigen::Vector3d> operator()(const Eigen::Vector3d& q) const;

 private:
  struct Query;
  struct Unknowns;
  struct Equations;

  [[nodiscard]] double beyond_section(double q, double share_beyond, int axis) const;
  [[nodiscard]] double pushed_height(const Eigen::Vector3d& q) const;
  [[nodiscard]] std::optional<double> height_on_wall(const Query& q) const;
  [[nodiscard]] Unknowns start(const Query& q) const;
  [[nodiscard]] Unknowns start_untapered(const Eigen::Array3d& q, const Eigen::Array3d& log_q) const;
  [[nodiscard]] Equations equations_at(const Unknowns& u, const Query& q) const;
  [[nodiscard]] Unknowns step(const Equations& e) const;
  [[nodiscard]] std::optional<Eigen::Vector3d> on_side(const Eigen::Vector3d& q, double pushed, double side) const;

  Eigen::Array3d axes_, log_axes_;
  double p1_, p2_;
  double k_, fall_;  ///< k, 1 - k²
};

}  // namespace verisq::fit_search
