/// The key `areas` of the model format: boxes that group the points of the bone.
#pragma once

#include <vector>
#include <verisq/cavity.hpp>

#include "host/files/json_document.hpp"

namespace verisq {

/// What is in no area of its own: a name that no area of a file may have.
inline constexpr std::string_view elsewhere = "elsewhere";

/// [{"name": "proximal", "weight": 3, "box": [[x0, y0, z0], [x1, y1, z1]]}, ...]. Throws Error(input) for empty,
/// repeated and reserved names, negative weights and reversed corners.
[[nodiscard]] std::vector<AreaBox> read_area_boxes(const JsonValue& areas);

}  // namespace verisq
