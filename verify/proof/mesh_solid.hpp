/// A closed mesh as a solid: proves signed distances of points by itself, without a certificate.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "verify/proof/empty_neighbourhood.hpp"
#include "verify/proof/triangle_tree.hpp"
#include "verify/solids/paths.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// Ways to a point from points of a triangle. Whatever a share is, a way ends exactly in the triangle: which one is
// short only decides how tight bounds are.

using PreciseTriangle = std::array<PreciseVector, 3>;

[[nodiscard]] inline PreciseTriangle corners_of(const Triangle& triangle) {
  return {precise(triangle[0]), precise(triangle[1]), precise(triangle[2])};
}

/// A number in [0, 1], about way/whole; 0 unless the whole is proven to be above 0.
template <class T>
[[nodiscard]] BasicInterval<T> share(const BasicInterval<T>& way, const BasicInterval<T>& whole) {
  if (!(whole.lower() > T(0))) return {0};
  return {std::clamp((way / whole).lower(), T(0), T(1))};
}

/// From the nearest point of a side, about. `way` leads from one end of the side to the point, `side` to the other end.
template <class T>
[[nodiscard]] Vector3<T> way_from_side(const Vector3<T>& way, const Vector3<T>& side) {
  return way - side * share(way.dot(side), side.dot(side));
}

/// Where the foot on the plane has shares b, c >= 0 with b + c <= 1: from a point of the triangle near the foot.
/// `normal` is ab x ac; `way` leads from the corner a to the point.
template <class T>
[[nodiscard]] std::optional<Vector3<T>> way_from_face(const Vector3<T>& way, const Vector3<T>& ab, const Vector3<T>& ac,
                                                      const Vector3<T>& normal) {
  const BasicInterval<T> square_of_normal = normal.dot(normal);
  if (!(square_of_normal.lower() > T(0))) return std::nullopt;
  const T b = (normal.dot(cross(way, ac)) / square_of_normal).lower();
  const T c = (normal.dot(cross(ab, way)) / square_of_normal).lower();
  if (!(b >= T(0) && c >= T(0) && add(b, c, Direction::up) <= T(1))) return std::nullopt;
  return way - (ab * BasicInterval<T>(b) + ac * BasicInterval<T>(c));
}

/// The triangles of a closed mesh, and every point about which they wind (docs/mathematics.md §29). Immutable after
/// construction: safe to call from many threads.
class MeshSolid {
 public:
  /// Throws Error(input) unless the primitive's mesh is closed. Preconditions: the primitive has a mesh, and is valid.
  explicit MeshSolid(const Primitive& primitive);

  /// Encloses the distance to the nearest triangle, negative inside: nearly as tight as binary64 has it. [0, 0] for a
  /// point that is proven to lie on a triangle. A pose that is not exact in 127 bits may leave the sign of a point
  /// within some 2^-52 of its size beside the surface open: then [-d, d]. Precondition: finite.
  [[nodiscard]] Enclosure signed_distance(const Point& point) const {
    return signed_distance_of(motion_.local_point(point));
  }

  /// The same for any point of the enclosure, which is in the mesh's own frame.
  [[nodiscard]] Enclosure signed_distance_of(const PreciseVector& own) const;

  /// The place of all points of the cube about any point of the enclosed `centre`, in the model's frame. Precondition:
  /// half_width >= 0.
  [[nodiscard]] Place place_of_cube(const PreciseVector& centre, const Real& half_width) const;

  [[nodiscard]] const RigidMotion& motion() const { return motion_; }  ///< from the mesh's own frame
  [[nodiscard]] const TriangleTree& tree() const { return tree_; }     ///< in that frame

  /// In that frame, a vertex of each connected part of the surface, or several.
  [[nodiscard]] const std::vector<Point>& on_parts() const { return on_parts_; }

  /// In that frame, a sphere that contains the solid.
  [[nodiscard]] EnclosingSphere sphere() const;

  /// How often the triangles wind about the point. Precondition: it lies off them.
  [[nodiscard]] std::optional<int> winding_number(const PreciseVector& own) const;

 private:
  [[nodiscard]] std::optional<int> winding_number(const PreciseVector& own, std::size_t axis, bool upward) const;
  [[nodiscard]] std::optional<bool> lies_on_one_of(std::span<const std::uint32_t> triangles,
                                                   const PreciseVector& own) const;

  RigidMotion motion_;
  TriangleTree tree_;
  std::vector<Point> on_parts_;
};

/// A moved mesh, rounded to binary64.
struct PlacedMesh {
  Mesh mesh;
  double displacement = 0.0;  ///< no point lies farther from the exact one
};

/// Precondition: finite.
[[nodiscard]] PlacedMesh placed(const Mesh& mesh, const RigidMotion& motion);

/// A mesh, or a cloud, as a posed primitive sees it: moved into the primitive's own frame. Distances to it are at least
/// 0, and hold for its exact triangles. Immutable after construction: safe to call from many threads.
class SeenTriangles {
 public:
  /// Preconditions: finite, at least one vertex.
  SeenTriangles(const Mesh& mesh, const Pose& of_primitive);

  /// Encloses the distance to the nearest triangle. Precondition: finite.
  [[nodiscard]] Enclosure distance(const Point& own) const;

 private:
  double displacement_;
  std::optional<TriangleTree> tree_;  ///< nothing where the moved mesh leaves binary64: then no distance is known
};

/// The corners of a triangle by numbers that are equal for equal places.
using Corners = std::array<std::uint32_t, 3>;

/// For each triangle. Vertices in one place, as number (-0 is 0), have one number: that of one of them. Precondition:
/// indices in range, finite coordinates.
[[nodiscard]] std::vector<Corners> corners_by_place(const Mesh& mesh);

/// A side of a triangle: its ends in order, and whether the triangle runs from the first to the second.
struct SidedEdge {
  std::uint64_t ends;  ///< the lower number in the upper half
  std::uint32_t triangle;
  std::int32_t direction;  ///< 1 or -1
};

/// All sides between different places, sorted by their ends. Throws Error(input), with the number of open edges, unless
/// each edge is run through as often one way as the other (docs/mathematics.md §29).
[[nodiscard]] std::vector<SidedEdge> closed_edges(std::span<const Corners> triangles);

}  // namespace verisq::verify
