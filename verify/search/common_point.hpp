/// Looks for a point that overlapping superquadrics share.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "verisq/model.hpp"

namespace verisq::verify {

/// Somewhere in a frame: `rotation` and `offset` lead there from the solid's own frame, whose origin is its focus
/// (docs/mathematics.md §18).
struct PlacedSuperquadric {
  Superquadric solid;
  Eigen::Matrix3d rotation;
  Eigen::Vector3d offset;
};

/// A point with all gauges below 1, in plain floating point: it proposes and proves nothing. By the ellipsoid method,
/// which needs neither a start nor a well-shaped intersection; nothing where the interiors do not meet, or in less than
/// about 1e-9 of the first one's size. Precondition: at least one.
[[nodiscard]] std::optional<Eigen::Vector3d> common_point(std::span<const PlacedSuperquadric> solids);

/// The same of two, in A's frame; `rotation` and `offset` lead there from B's.
[[nodiscard]] std::optional<Eigen::Vector3d> common_point(const Superquadric& a, const Superquadric& b,
                                                          const Eigen::Matrix3d& rotation,
                                                          const Eigen::Vector3d& offset);

}  // namespace verisq::verify
