/// Fuzz target of read_mesh for STL, binary and ASCII.
#include "tests/fuzz/mesh_promise.hpp"

namespace verisq::fuzz {

void stl(Bytes bytes) {
  static const MemoryFile file(".stl");
  read_as_mesh(file, bytes);
}

}  // namespace verisq::fuzz
