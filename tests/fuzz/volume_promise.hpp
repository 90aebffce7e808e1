/// What read_label_volume promises, for the targets of the volume formats.
#pragma once

#include "tests/fuzz/memory_file.hpp"

namespace verisq::fuzz {

/// Reads the bytes as the volume that `file` is to hold.
void read_as_volume(const MemoryFile& file, Bytes bytes);

}  // namespace verisq::fuzz
