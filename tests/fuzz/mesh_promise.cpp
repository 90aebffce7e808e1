/// Checks meshes that were accepted.
#include "tests/fuzz/mesh_promise.hpp"

#include <cmath>
#include <verisq/files.hpp>

#include "tests/fuzz/promise.hpp"

namespace verisq::fuzz {
namespace {

void check_mesh(const Mesh& mesh) {
  check(!mesh.vertices.empty(), "a mesh has vertices");
  for (const Point& vertex : mesh.vertices) {
    for (const double coordinate : vertex) check(std::isfinite(coordinate), "coordinates are finite");
  }
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t index : triangle) check(index < mesh.vertices.size(), "indices are those of vertices");
    const auto& [a, b, c] = triangle;
    check(a != b && b != c && c != a, "a triangle has three vertices");
  }
}

}  // namespace

void read_as_mesh(const MemoryFile& file, Bytes bytes) {
  file.write(bytes);
  read_or_refuse(file.path().string(), [&] { check_mesh(read_mesh(file.path())); });
}

}  // namespace verisq::fuzz
