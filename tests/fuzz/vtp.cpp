/// Fuzz target of read_mesh for VTK's PolyData in XML.
#include "tests/fuzz/mesh_promise.hpp"

namespace verisq::fuzz {

void vtp(Bytes bytes) {
  static const MemoryFile file(".vtp");
  read_as_mesh(file, bytes);
}

}  // namespace verisq::fuzz
