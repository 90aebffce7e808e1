/// The model format `verisq-model/1`, its areas, and the points of a femur by their names.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/clearance.hpp>
#include <verisq/features.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

#include "host/files/json_document.hpp"

namespace verisq {

// The key `areas` of the model format: boxes that group the points of the bone.

/// The name for everything outside of the areas: no area of a file may have it.
inline constexpr std::string_view elsewhere = "elsewhere";

// The points of a femur by their names, in landmark files and in model files alike.

/// {"head_centre": [x, y, z], ...}, any of `named_landmarks`. Throws Error(input) for other keys and values.
[[nodiscard]] FemurLandmarks read_landmark_points(const JsonValue& points);

/// The value of the object's key "side": "left" or "right"; nothing if there is none.
[[nodiscard]] std::optional<Side> read_side(const JsonValue& object);

// Models of meshes, and the digests of models, whose meshes may lie in files of their own.

/// The model of one mesh, named as its file. Throws Error(input) for a mesh that is not closed.
[[nodiscard]] Model model_of_mesh(Mesh mesh, const std::filesystem::path& path);

/// SHA-256 of the model's bytes, and behind them of all bytes of each mesh file that it names, in the order of its
/// primitives: what `cat model.json stem.stl | sha256sum` prints. `path` is the model's. Throws Error(input) for a mesh
/// file that cannot be read.
[[nodiscard]] std::string digest_of_model(std::string_view bytes, const std::filesystem::path& path);

}  // namespace verisq
