/// What read_mesh promises, for the targets of the mesh formats.
#pragma once

#include "tests/fuzz/memory_file.hpp"

namespace verisq::fuzz {

/// Reads the bytes as the mesh that `file` is to hold.
void read_as_mesh(const MemoryFile& file, Bytes bytes);

}  // namespace verisq::fuzz
