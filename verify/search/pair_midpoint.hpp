/// The closest points of two superquadrics by way of the midpoint between them, in plain binary64.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "verisq/model.hpp"

namespace verisq::verify {

/// All in A's own frame but `on_b`, which is in B's.
struct MidpointContact {
  Eigen::Vector3d vector;  ///< from A to B, normal to both
  Eigen::Vector3d on_a;
  Eigen::Vector3d on_b;
};

/// Newton's method on half the squared distance to A plus half that to B, which is convex: at its minimum the vectors
/// from both solids cancel. Nothing where it does not converge, as where the solids overlap. `rotation` and `offset`
/// lead from B's frame to A's.
[[nodiscard]] std::optional<MidpointContact> midpoint_contact(const Superquadric& a, const Superquadric& b,
                                                              const Eigen::Matrix3d& rotation,
                                                              const Eigen::Vector3d& offset,
                                                              const Eigen::Vector3d& start);

}  // namespace verisq::verify
