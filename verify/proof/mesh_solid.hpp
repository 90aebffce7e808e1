/// A closed mesh as a solid: proves signed distances of points by itself, without a certificate.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "verify/proof/empty_neighbourhood.hpp"
#include "verify/proof/triangle_tree.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

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
  [[nodiscard]] const std::vector<Point>& on_surfaces() const { return on_surfaces_; }

 private:
  [[nodiscard]] std::optional<int> winding_number(const PreciseVector& own) const;
  [[nodiscard]] std::optional<int> winding_number(const PreciseVector& own, std::size_t axis, bool upward) const;
  [[nodiscard]] std::optional<bool> lies_on_one_of(std::span<const std::uint32_t> triangles,
                                                   const PreciseVector& own) const;

  RigidMotion motion_;
  TriangleTree tree_;
  std::vector<Point> on_surfaces_;
};

/// A moved mesh, rounded to binary64.
struct PlacedMesh {
  Mesh mesh;
  double displacement = 0.0;  ///< no point lies farther from the exact one
};

/// Precondition: finite.
[[nodiscard]] PlacedMesh placed(const Mesh& mesh, const RigidMotion& motion);

}  // namespace verisq::verify
