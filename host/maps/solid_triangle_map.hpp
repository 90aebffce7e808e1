/// The map of triangles about any model: by signed distances of points of theirs.
#pragma once

#include <memory>

#include "host/maps/exact_map.hpp"

namespace verisq {

/// As triangle_map, for models that are not is_union_of_convex. Throws Error(input) for a model that is proven to have
/// no point, and for options that ask for certificates without covers.
[[nodiscard]] std::unique_ptr<ExactMap<Triangle>> solid_triangle_map(const Model& model, const MapOptions& options);

}  // namespace verisq
