/// Fuzz target of read_mesh for OFF.
#include "tests/fuzz/mesh_promise.hpp"

namespace verisq::fuzz {

void off(Bytes bytes) {
  static const MemoryFile file(".off");
  read_as_mesh(file, bytes);
}

}  // namespace verisq::fuzz
