/// What MapReader promises, for the targets of its formats.
#pragma once

#include "tests/fuzz/memory_file.hpp"

namespace verisq::fuzz {

/// Reads the bytes as the certified map that `file` is to hold.
void read_as_map(const MemoryFile& file, Bytes bytes);

}  // namespace verisq::fuzz
