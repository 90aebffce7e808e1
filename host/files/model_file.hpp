/// The model format `verisq-model/1`, its areas, and the points of a femur by their names.
#pragma once

#include <optional>
#include <vector>
#include <verisq/clearance.hpp>
#include <verisq/features.hpp>

#include "host/files/json_document.hpp"

namespace verisq {

// The key `areas` of the model format: boxes that group the points of the bone.

/// The name for everything outside of the areas: no area of a file may have it.
inline constexpr std::string_view elsewhere = "elsewhere";

/// [{"name": "proximal", "weight": 3, "box": [[x0, y0, z0], [x1, y1, z1]]}, ...]. Throws Error(input) for empty,
/// repeated and reserved names, negative weights and reversed corners.
[[nodiscard]] std::vector<AreaBox> read_area_boxes(const JsonValue& areas);

// The points of a femur by their names, in landmark files and in model files alike.

/// {"head_centre": [x, y, z], ...}, any of `named_landmarks`. Throws Error(input) for other keys and values.
[[nodiscard]] FemurLandmarks read_landmark_points(const JsonValue& points);

/// The value of the object's key "side": "left" or "right"; nothing if there is none.
[[nodiscard]] std::optional<Side> read_side(const JsonValue& object);

}  // namespace verisq
