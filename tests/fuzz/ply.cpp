/// Fuzz target of read_mesh for PLY, ASCII and binary of both byte orders.
#include "tests/fuzz/mesh_promise.hpp"

namespace verisq::fuzz {

void ply(Bytes bytes) {
  static const MemoryFile file(".ply");
  read_as_mesh(file, bytes);
}

}  // namespace verisq::fuzz
