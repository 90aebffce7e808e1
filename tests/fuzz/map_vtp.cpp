/// Fuzz target of MapReader for .vtp.
#include "tests/fuzz/map_promise.hpp"

namespace verisq::fuzz {

void map_vtp(Bytes bytes) {
  static const MemoryFile file(".vtp");
  read_as_map(file, bytes);
}

}  // namespace verisq::fuzz
