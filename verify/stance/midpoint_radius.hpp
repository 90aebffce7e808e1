/// Products of interval matrices by midpoints and radii: four ordinary products, and a bound of all rounding errors.
#pragma once

#include "verify/stance/contraction.hpp"

namespace verisq::stance {

/// All matrices within `radius` of `midpoint`, entry by entry.
struct MidpointRadius {
  Eigen::MatrixXd midpoint, radius;

  MidpointRadius(const Eigen::MatrixXd& exact);     // NOLINT(google-explicit-constructor): a matrix is a thin one
  MidpointRadius(const IntervalMatrix& intervals);  // NOLINT(google-explicit-constructor): the same set or a larger one

  [[nodiscard]] IntervalMatrix intervals() const;

 private:
  MidpointRadius(Eigen::MatrixXd midpoint_of_all, Eigen::MatrixXd radius_of_all);
  friend MidpointRadius operator*(const MidpointRadius& a, const MidpointRadius& b);
};

/// Contains all products of the two. At most 1.5 times as wide as the narrowest that does, but for rounding (Rump 1999,
/// Fast and parallel interval arithmetic). Throws std::domain_error beyond binary64.
[[nodiscard]] MidpointRadius operator*(const MidpointRadius& a, const MidpointRadius& b);

}  // namespace verisq::stance
