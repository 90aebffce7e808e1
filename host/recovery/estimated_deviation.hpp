/// How far samples of two surfaces lie apart, in floating point.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>
#include <verisq/recovery.hpp>

#include "host/recovery/shape.hpp"
#include "verify/deviation/triangle_tree.hpp"

namespace verisq::recovery {

/// Of the points to the boundary of the union of the shapes, to first order. Precondition: at least one point.
[[nodiscard]] EstimatedDeviation deviation_to_union(std::span<const Eigen::Vector3d> points,
                                                    std::span<const Shape> shapes);

/// Of samples of the union's boundary to the mesh; nothing when it has none.
[[nodiscard]] std::optional<EstimatedDeviation> deviation_to_mesh(std::span<const Shape> shapes,
                                                                  const verify::TriangleTree& mesh, std::uint64_t seed);

/// Both. `mesh` may be null: a cloud has none.
[[nodiscard]] RecoveryStage stage_of(std::span<const Shape> shapes, std::span<const Eigen::Vector3d> points,
                                     const verify::TriangleTree* mesh, std::uint64_t seed);

}  // namespace verisq::recovery
