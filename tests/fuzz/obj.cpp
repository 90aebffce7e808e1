/// Fuzz target of read_mesh for OBJ.
#include "tests/fuzz/mesh_promise.hpp"

namespace verisq::fuzz {

void obj(Bytes bytes) {
  static const MemoryFile file(".obj");
  read_as_mesh(file, bytes);
}

}  // namespace verisq::fuzz
