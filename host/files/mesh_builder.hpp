/// Collects the vertices and polygons of a mesh file and refuses what is not a surface.
#pragma once

#include <cstdint>
#include <span>
#include <verisq/mesh.hpp>

#include "host/files/input_file.hpp"

namespace verisq {

/// Every refusal is an Error(input) at the position of what `file` read last.
class MeshBuilder {
 public:
  explicit MeshBuilder(const InputFile& file) : file_(file) {}

  [[nodiscard]] const Mesh& mesh() const { return mesh_; }

  /// Precondition: the counts are bounded by the size of the file, or a header could ask for all memory.
  void reserve(std::size_t vertices, std::size_t triangles);

  /// Fails when an index would not fit into 32 bits. Precondition: finite coordinates.
  std::uint32_t add_vertex(const Point& vertex);

  /// `index` (from 0) as an index of the vertices so far; fails when it is out of range.
  [[nodiscard]] std::uint32_t checked_index(std::int64_t index) const;

  /// Fails for fewer than three corners.
  void check_corner_count(std::int64_t count) const;

  /// Splits the polygon into the fan of triangles around its first corner. Fails for fewer than three corners and for
  /// a triangle of exactly zero area, which a polygon with three corners in a line can hold, too. Precondition: checked
  /// indices.
  void add_polygon(std::span<const std::uint32_t> corners);

  /// The mesh. Fails when it has no vertices.
  [[nodiscard]] Mesh finish() &&;

 private:
  const InputFile& file_;
  Mesh mesh_;
};

}  // namespace verisq
