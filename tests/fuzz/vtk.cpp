/// Fuzz target of read_mesh for VTK's PolyData in the legacy form.
#include "tests/fuzz/mesh_promise.hpp"

namespace verisq::fuzz {

void vtk(Bytes bytes) {
  static const MemoryFile file(".vtk");
  read_as_mesh(file, bytes);
}

}  // namespace verisq::fuzz
