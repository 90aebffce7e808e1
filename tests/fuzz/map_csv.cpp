/// Fuzz target of MapReader for .csv.
#include "tests/fuzz/map_promise.hpp"

namespace verisq::fuzz {

void map_csv(Bytes bytes) {
  static const MemoryFile file(".csv");
  read_as_map(file, bytes);
}

}  // namespace verisq::fuzz
