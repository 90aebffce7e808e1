/// The mesh formats: one function and one source file each.
#pragma once

#include <cstdint>
#include <string>
#include <vector>
#include <verisq/mesh.hpp>

#include "host/files/input_file.hpp"

namespace verisq {

// Each reads the whole of `file` from its start and throws Error(input) as read_mesh documents.
[[nodiscard]] Mesh read_stl(InputFile& file);
[[nodiscard]] Mesh read_obj(InputFile& file);
[[nodiscard]] Mesh read_ply(InputFile& file);
[[nodiscard]] Mesh read_off(InputFile& file);

/// One label a vertex.
struct LabelledMesh {
  Mesh mesh;
  std::vector<std::int64_t> labels;
};

/// As read_ply, with an integer property of the vertices. Throws Error(input) where there is none of this name, and
/// where it is a list, a floating-point number or a coordinate.
[[nodiscard]] LabelledMesh read_labelled_ply(InputFile& file, const std::string& property);

}  // namespace verisq
