/// Reads meshes: STL (binary, ASCII), OBJ, PLY (ASCII, binary of both byte orders), OFF.
#pragma once

#include <filesystem>
#include <verisq/mesh.hpp>

namespace verisq {

/// The format follows the extension (any case). Coordinates: text to the nearest binary64, binary floats exactly.
/// Equal STL corners are merged; polygons of other formats are split into triangle fans.
/// Throws Error(input) naming file and line or byte position for: NaN, infinity, empty or truncated files, indices
/// out of range, triangles of exactly zero area, unknown formats.
[[nodiscard]] Mesh read_mesh(const std::filesystem::path& path);

}  // namespace verisq
