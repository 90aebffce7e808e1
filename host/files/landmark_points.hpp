/// The points of a femur by their names, in landmark files and in model files alike.
#pragma once

#include <verisq/features.hpp>

#include "host/files/json_document.hpp"

namespace verisq {

/// {"head_centre": [x, y, z], ...}, any of `named_landmarks`. Throws Error(input) for other keys and values.
[[nodiscard]] FemurLandmarks read_landmark_points(const JsonValue& points);

}  // namespace verisq
