/// Gives equal points one index: STL repeats every vertex for each triangle that meets there.
#pragma once

#include <cstdint>
#include <vector>

#include "host/files/mesh_builder.hpp"

namespace verisq {

/// An open-addressing hash table of vertex indices, four bytes a slot, at most half full: 10^7 triangles take 64 MiB
/// where std::unordered_map takes a gigabyte. Equal means equal as numbers: -0.0 and 0.0 are one.
class VertexMerger {
 public:
  explicit VertexMerger(MeshBuilder& builder);

  /// The index of the vertex equal to `point`, added when new. Precondition: finite coordinates.
  std::uint32_t index_of(const Point& point);

 private:
  [[nodiscard]] std::size_t slot_of(const Point& point) const;
  void grow();

  MeshBuilder& builder_;
  std::vector<std::uint32_t> slots_;  // vertex index, or `empty`; the size is a power of two
};

}  // namespace verisq
