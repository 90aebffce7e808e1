/// Fuzz target of read_label_volume for NRRD.
#include "tests/fuzz/volume_promise.hpp"

namespace verisq::fuzz {

void nrrd(Bytes bytes) {
  static const MemoryFile file(".nrrd");
  read_as_volume(file, bytes);
}

}  // namespace verisq::fuzz
