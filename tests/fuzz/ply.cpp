/// Fuzz target of read_mesh and read_labelled_cavity for PLY, ASCII and binary of both byte orders.
#include <verisq/clearance.hpp>

#include "tests/fuzz/mesh_promise.hpp"
#include "tests/fuzz/promise.hpp"

namespace verisq::fuzz {

namespace {

void check_cavity(const Cavity& cavity) {
  check(!cavity.points.empty(), "a cavity has points");
  check(cavity.area_of.size() == cavity.points.size(), "each point has its area");
  for (const std::uint32_t index : cavity.area_of) check(index < cavity.areas.size(), "indices are those of areas");
}

}  // namespace

void ply(Bytes bytes) {
  static const MemoryFile file(".ply");
  read_as_mesh(file, bytes);
  read_or_refuse(file.path().string(), [&] { check_cavity(read_labelled_cavity(file.path(), "label", {})); });
}

}  // namespace verisq::fuzz
