/// Closed meshes among other primitives: distances of points, triangles and models, and closest points.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "verify/proof/model_checker.hpp"
#include "verify/search/closed_mesh.hpp"
#include "verify/search/solid_distance.hpp"
#include "verify/search/wide_tree.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/checker.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/hidden.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// The closest point of a mesh, proven in 127-bit intervals (docs/mathematics.md §29). Nothing if several points may be
/// closest, if the point may lie on the surface, or inside where triangles cross. `primitive` is left out.
[[nodiscard]] std::optional<ClosestPoint> closest_point(const PosedMesh& mesh, const Point& point);

/// Immutable: safe to ask from many threads.
class MeshUnion {
 public:
  /// Throws Error(input) unless the model is the union of its primitives, and for meshes that are not closed.
  /// Precondition: valid, has_mesh(model).
  explicit MeshUnion(const Model& model);
  ~MeshUnion();
  MeshUnion(MeshUnion&&) noexcept;
  MeshUnion& operator=(MeshUnion&&) noexcept;

  struct Part {
    std::uint32_t primitive;  ///< index in Model::primitives
    PosedMesh mesh;
  };
  [[nodiscard]] std::span<const Part> meshes() const { return meshes_; }
  /// The model of all other primitives, which are superquadrics; nothing if there are none.
  [[nodiscard]] const std::optional<Model>& others() const { return others_; }
  /// Normals of the model of the others, as those of the union.
  [[nodiscard]] std::vector<Normal> renumbered(std::vector<Normal> normals) const;

  /// Encloses the signed distance, with what proves it beside the meshes themselves. `tolerance` is of the search among
  /// superquadrics. Precondition: finite.
  [[nodiscard]] CertifiedEnclosure operator()(const Point& point, double tolerance, bool certified,
                                              const std::function<bool()>& interrupted) const;

  /// The same without a search, from distances to each mesh, in order, and to the others, whose certificate is of their
  /// own model.
  [[nodiscard]] CertifiedEnclosure joined(const Point& point, std::span<const ClosedMesh::Distance> to_meshes,
                                          const std::optional<CertifiedEnclosure>& to_others) const;

  /// Narrows an enclosure that is wider than the tolerance by a search, in a union of several primitives. An upper end
  /// with a certificate is left as it is.
  void narrow(const Point& point, double tolerance, bool certified, const std::function<bool()>& interrupted,
              CertifiedEnclosure& found) const;

  /// As SignedDistance::closest_point where it is proven.
  [[nodiscard]] std::optional<ClosestPoint> closest_point(const Point& point) const;

 private:
  [[nodiscard]] bool is_outside(const Point& point) const;
  [[nodiscard]] std::optional<Point> escape(const Point& point, std::span<const ClosedMesh::Distance> to_meshes,
                                            bool may_be_in_others) const;

  std::vector<Part> meshes_;
  std::optional<Model> others_;
  std::vector<std::uint32_t> index_of_;        ///< of each of the others, in Model::primitives
  std::unique_ptr<SignedDistance> to_others_;  ///< where there are some
  std::unique_ptr<SolidDistance> search_;      ///< of several primitives
  double size_;                                ///< no coordinate of the solid is larger
};

/// Encloses the distance of two closed triangles, which may be degenerate. [0, 0] proves that they meet: exactly, where
/// a side of one passes through the other. Preconditions: finite; differences no larger than 2^300.
[[nodiscard]] Enclosure distance_of_triangles(const Triangle& a, const Triangle& b);

/// Encloses the distance of some triangles to those of the tree. Once interrupted, the lower end is 0. Preconditions:
/// at least one triangle; as for the tree's queries.
[[nodiscard]] Enclosure distance_of_triangles(std::span<const Triangle> triangles, const WideTree& tree,
                                              const std::function<bool()>& interrupted);

/// The distance of a triangle to a union of meshes and superquadrics, 0 where they meet. Immutable: safe to ask from
/// many threads.
class MeshTriangleDistance {
 public:
  /// Throws as MeshUnion, and Error(input) for bent superquadrics.
  explicit MeshTriangleDistance(const Model& model);

  /// Precondition: finite.
  [[nodiscard]] Enclosure operator()(const Triangle& triangle) const;

  /// The same with what proves it beside the meshes themselves: the enclosure is what `Checker` proves.
  [[nodiscard]] CertifiedEnclosure certified(const Triangle& triangle) const;

 private:
  [[nodiscard]] Enclosure to_meshes(const Triangle& triangle) const;

  Model model_;
  MeshUnion solids_;
  std::optional<TriangleDistance> to_others_;
  mutable std::once_flag is_checker_made_;
  mutable std::optional<ModelChecker> checker_;  ///< made for the first certificate: it has trees of its own
};

/// The distance of two solids, 0 where they meet.
struct MeshPair {
  Enclosure distance;
  /// They meet, and still do if one of them is moved by no more than this. 0 where that is not known.
  double depth = 0.0;
  /// Proposed: a point in both, in the frame of A.
  std::optional<Point> common = {};
};

/// The distance of two unions of meshes and superquadrics, one of which has a mesh. Immutable: safe to ask from many
/// threads.
class MeshPairDistance {
 public:
  /// Throws Error(input) unless each is the union of its primitives, and for bent superquadrics.
  MeshPairDistance(const Model& a, const Model& b);

  /// Encloses the distance of A and of B moved by `pose`. Once interrupted, the lower end is 0.
  [[nodiscard]] MeshPair operator()(const Pose& pose, const std::function<bool()>& interrupted) const;

  /// As ModelSearch::operator(). Near points are left out.
  [[nodiscard]] SearchedDistance searched(const Pose& pose, const SearchOptions& options) const;

 private:
  struct State;
  Hidden<State> state_;
};

}  // namespace verisq::verify
