/// Fuzz target of read_label_volume for NIfTI-1.
#include "tests/fuzz/volume_promise.hpp"

namespace verisq::fuzz {

void nifti(Bytes bytes) {
  static const MemoryFile file(".nii");
  read_as_volume(file, bytes);
}

}  // namespace verisq::fuzz
