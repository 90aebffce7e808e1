/// Reads and writes meshes: STL (binary, ASCII), OBJ, PLY (ASCII, binary of both byte orders), OFF.
#pragma once

#include <filesystem>
#include <verisq/mesh.hpp>

namespace verisq {

/// The format follows the extension (any case). Coordinates: text to the nearest binary64, binary floats exactly.
/// Equal STL corners are merged; polygons of other formats are split into triangle fans.
/// Throws Error(input) naming file and line or byte position for: NaN, infinity, empty or truncated files, indices
/// out of range, triangles of exactly zero area, unknown formats.
[[nodiscard]] Mesh read_mesh(const std::filesystem::path& path);

/// Whether `read_mesh` knows the format of that name.
[[nodiscard]] bool is_mesh_name(const std::filesystem::path& path);

/// Throws Error(input) unless `write_mesh` knows the format of that name.
void check_mesh_name(const std::filesystem::path& path);

/// Writes what `read_mesh` reads: PLY (binary little-endian, binary64), OFF and OBJ (text) give the same mesh again;
/// STL (binary) rounds coordinates to binary32 and forgets vertices of no triangle. The file appears when it is
/// complete. Throws Error(input) for an unknown format, coordinates that are not finite (in STL: after rounding) and
/// triangles of exactly zero area (likewise), Error(failure) when the file cannot be written. Precondition: indices
/// in range.
void write_mesh(const std::filesystem::path& path, const Mesh& mesh);

}  // namespace verisq
