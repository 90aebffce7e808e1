/// The map of poses where a model has a bend or set operations.
#pragma once

#include <memory>

#include "host/maps/exact_map.hpp"

namespace verisq {

/// As pose_map, by ModelSearch, pose by pose on all processors: no kernel knows such pairs. Throws Error(input)
/// likewise, and for a model that is proven to have no point.
[[nodiscard]] std::unique_ptr<ExactMap<Pose>> solid_pose_map(const Model& a, const Model& b, const MapOptions& options);

}  // namespace verisq
