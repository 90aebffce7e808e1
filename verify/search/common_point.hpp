/// Looks for a point that two overlapping superquadrics share.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "verisq/model.hpp"

namespace verisq::verify {

/// A point of A's frame with both gauges below 1, in plain floating point: it proposes and proves nothing. `rotation`
/// and `offset` lead from B's frame to A's. By the ellipsoid method, which needs neither a start nor a well-shaped
/// intersection; nothing where the interiors do not meet, or in less than about 1e-9 of A's size.
[[nodiscard]] std::optional<Eigen::Vector3d> common_point(const Superquadric& a, const Superquadric& b,
                                                          const Eigen::Matrix3d& rotation,
                                                          const Eigen::Vector3d& offset);

}  // namespace verisq::verify
