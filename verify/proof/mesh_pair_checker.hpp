/// Proves distances of closed meshes to triangles and to models, without a certificate.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "verify/proof/mesh_solid.hpp"
#include "verify/proof/pair_checker.hpp"
#include "verify/solids/paths.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// The primitives of a model: each is a closed mesh or an unbent superquadric.
struct MeshModel {
  /// Throws Error(input) for a mesh that is not closed, for bends, and unless the model is the union of its
  /// primitives.
  explicit MeshModel(const Model& model);

  std::vector<MeshSolid> meshes;
  PosedPrimitives others;
};

/// Encloses the distance of a triangle, of the model's frame, to the solid: 0 where they meet. Once interrupted, the
/// lower end is 0. Precondition: finite.
[[nodiscard]] Enclosure distance_of(const Triangle& triangle, const MeshSolid& mesh, const Hook& interrupted);

/// True proves that these triangles, of the model's frame, have no point in common with those of the mesh. False proves
/// nothing, as once interrupted. Precondition: finite.
[[nodiscard]] bool keep_off_surface(std::span<const Triangle> triangles, const MeshSolid& mesh,
                                    const Hook& interrupted);

/// Two such models, B of which is moved. It finds the nearest triangles itself (docs/mathematics.md §29). Immutable
/// after construction: safe to call from many threads.
class MeshPairChecker {
 public:
  /// Throws like MeshModel.
  MeshPairChecker(const Model& a, const Model& b) : a_(a), b_(b) {}

  /// Encloses the distance: 0 where the models meet. A point of A's frame that both have in `common` proves that they
  /// do; without one a superquadric that a surface only cuts is proven to be near. The lower end holds at all times of
  /// B's motion, the upper end at its moment. Once interrupted, the lower end is 0.
  [[nodiscard]] Enclosure distance(const ShortMotion& motion, const std::optional<Point>& common,
                                   const Hook& interrupted) const;

 private:
  [[nodiscard]] static Enclosure moving(const Enclosure& at_moment, const PreciseInterval& way);
  [[nodiscard]] Enclosure from_a(const MeshSolid& b, const RigidMotion& b_to_a, const Hook& interrupted) const;
  [[nodiscard]] Enclosure from_a(const PosedSuperquadric& b, const RigidMotion& b_to_a, const Hook& interrupted) const;

  MeshModel a_, b_;
};

}  // namespace verisq::verify
