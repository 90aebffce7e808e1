/// The points of a femur by their names, in landmark files and in model files alike.
#pragma once

#include <optional>
#include <verisq/features.hpp>

#include "host/files/json_document.hpp"

namespace verisq {

/// {"head_centre": [x, y, z], ...}, any of `named_landmarks`. Throws Error(input) for other keys and values.
[[nodiscard]] FemurLandmarks read_landmark_points(const JsonValue& points);

/// Of the object's key "side": "left" or "right", nothing where there is none.
[[nodiscard]] std::optional<Side> read_side(const JsonValue& object);

}  // namespace verisq
