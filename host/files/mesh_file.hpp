/// Meshes from files: the formats, and their common parts; the division of polygons into triangles.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

#include "host/files/input_file.hpp"

namespace verisq {

// The mesh formats: one function and one source file each.

// Each reads the whole of `file` from its start and throws Error(input) as read_mesh documents.
[[nodiscard]] Mesh read_stl(InputFile& file);
[[nodiscard]] Mesh read_obj(InputFile& file);
[[nodiscard]] Mesh read_ply(InputFile& file);
[[nodiscard]] Mesh read_off(InputFile& file);
[[nodiscard]] Mesh read_vtp(InputFile& file);
[[nodiscard]] Mesh read_vtk(InputFile& file);

/// One label a vertex.
struct LabelledMesh {
  Mesh mesh;
  std::vector<std::int64_t> labels;
};

/// Like read_ply, with an integer property of the vertices. Throws Error(input) if there is none of this name, or if it
/// is a list, a floating-point number or a coordinate.
[[nodiscard]] LabelledMesh read_labelled_ply(InputFile& file, const std::string& property);

// Collects the vertices and polygons of a mesh file and refuses data that are not a surface.

/// Every refusal is an Error(input) at the position that `file` read last.
class MeshBuilder {
 public:
  explicit MeshBuilder(const InputFile& file) : file_(file) {}

  [[nodiscard]] const Mesh& mesh() const { return mesh_; }

  /// Precondition: the counts are bounded by the size of the file, or a header could ask for all memory.
  void reserve(std::size_t vertices, std::size_t triangles);

  /// Fails when an index would not fit into 32 bits. Precondition: finite coordinates.
  std::uint32_t add_vertex(const Point& vertex);

  /// `index` (from 0) as an index of the vertices so far, counted from `first` on; fails when it is out of range.
  /// Precondition: not more than all vertices are before the first.
  [[nodiscard]] std::uint32_t checked_index(std::int64_t index, std::size_t first = 0) const;

  /// Fails for fewer than three corners.
  void check_corner_count(std::int64_t count) const;

  /// Splits the polygon into triangles by `triangles_of_polygon`. A triangle may have no area. Fails for fewer than
  /// three corners and for polygons that cannot be split. Precondition: checked indices.
  void add_polygon(std::span<const std::uint32_t> corners);

  /// The mesh. Triangles that name a vertex twice are left out: they are sides of other triangles. Fails if one is
  /// none, and when the mesh has no vertices.
  [[nodiscard]] Mesh finish() &&;

 private:
  /// A triangle that names a vertex twice: a line, or a point.
  struct Folded {
    std::array<std::uint32_t, 3> triangle;
    std::size_t number;  ///< in the file, from 1
  };

  void add_triangle(const std::array<std::uint32_t, 3>& triangle);
  void leave_out_folded() const;

  const InputFile& file_;
  Mesh mesh_;
  std::vector<Folded> folded_;
  std::uint64_t polygons_ = 0;
  std::vector<Point> polygon_;  // the one added last
};

// Gives equal points one index: STL repeats every vertex for each triangle that meets there.

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

// Decides exactly the orientation of three points, and whether a triangle has zero area.

/// Two coordinates of points, in this order: their projection along the third axis.
using CoordinatePlane = std::array<std::size_t, 2>;

/// 1 if the triangle of exactly these corners runs anticlockwise in the plane, -1 if it runs clockwise, 0 if its
/// projection has no area. Never wrong because of rounding, underflow or overflow. Precondition: finite corners.
[[nodiscard]] int turn(const Point& a, const Point& b, const Point& c, const CoordinatePlane& plane);

/// True if and only if the real area of the triangle with exactly these corners is zero: two corners are equal or all
/// three lie on a line. As exact as `turn`. Precondition: finite corners.
[[nodiscard]] bool has_zero_area(const Point& a, const Point& b, const Point& c);

// Divides a polygon of a mesh file into triangles that cover its area, and nothing else.

/// Corners are positions in the polygon.
struct PolygonTriangles {
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< in the polygon's sense; none has zero area
  std::string defect = {};  ///< the reason why there are none, to follow "face N: "; else empty
};

/// A convex polygon becomes the fan around its first corner, however its corners are bent out of a plane: quadrangles
/// of CAD often are, and the fan determines the intended surface. (Not if it is bent by more than its size.) If a fan
/// would cover points outside or contain a triangle without area, ears are cut off. Such a polygon must be plane, as
/// far as roundings of its coordinates to six digits allow, and have at most 4,096 corners. Polygons that cross or
/// touch themselves have a defect. Precondition: at least four corners, finite.
[[nodiscard]] PolygonTriangles triangles_of_polygon(std::span<const Point> corners);

}  // namespace verisq
