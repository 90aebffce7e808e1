/// The mesh formats: one function and one source file each.
#pragma once

#include <verisq/mesh.hpp>

#include "host/files/input_file.hpp"

namespace verisq {

// Each reads the whole of `file` from its start and throws Error(input) as read_mesh documents.
[[nodiscard]] Mesh read_stl(InputFile& file);
[[nodiscard]] Mesh read_obj(InputFile& file);
[[nodiscard]] Mesh read_ply(InputFile& file);
[[nodiscard]] Mesh read_off(InputFile& file);

}  // namespace verisq
