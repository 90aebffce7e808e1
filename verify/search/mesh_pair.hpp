/// Distances of triangles, and of other models, to closed meshes.
#pragma once

#include <functional>
#include <optional>
#include <span>

#include "verify/search/mesh_union.hpp"
#include "verify/search/wide_tree.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/hidden.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

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

 private:
  MeshUnion solids_;
  std::optional<TriangleDistance> to_others_;
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
