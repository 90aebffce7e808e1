/// Cubes of an octree, and how they are divided.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "verify/proof/exact_checker.hpp"
#include "verify/search/set_tree.hpp"
#include "verify/solids/cube.hpp"
#include "verisq/checker.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"
#include "verisq/octree.hpp"

namespace verisq::verify {

// Cubes that halve exactly, and how far a point is from them.

/// The conditions on a root cube, in half-widths of it.
struct RootCubeRule {
  double margin = 0.0;         ///< the box lies at least this far within its faces; below 1/8
  double farthest = infinity;  ///< no coordinate of its centre is farther from 0; at least 16
};

/// Half-widths of root cubes are not less: cubes of the deepest levels would underflow.
inline constexpr double smallest_root = 0x1p-1001;

/// The cube from which octrees and searches grow, on the host and on devices: it contains the box. Its half-width is
/// the least power of two, from `smallest_root` on, for which a centre on a grid of 1/1024 of it keeps the rule. If no
/// coordinate of that centre is farther than 2^f half-widths (and f at least 4), centres and corners of all cubes that
/// are halved from it are binary64 numbers down to 2^-(51 - f) half-widths. Nothing if that overflows.
[[nodiscard]] std::optional<Cube> root_cube(const Box& box, const RootCubeRule& rule = {});

/// The eight halves, which cover the cube. Nothing if a centre is not representable.
[[nodiscard]] std::optional<std::array<Cube, 8>> halves(const Cube& cube);

/// An exact comparison: false proves that x lies beyond a face.
[[nodiscard]] bool contains(const Cube& cube, const Point& x);

/// Encloses the distance of x to the cube, 0 within.
[[nodiscard]] Enclosure distance(const Point& x, const Cube& cube);

/// Encloses the distance of an x within the cube to its faces. Precondition: contains(cube, x).
[[nodiscard]] Enclosure distance_to_faces(const Point& x, const Cube& cube);

// The octree of a solid: its root, exact cubes, the colours of eight siblings, volumes (docs/mathematics.md §10).

/// Contains the model's solid. Throws Error(input) where no such cube has exact corners.
[[nodiscard]] OctreeRoot octree_root(const Model& model);

/// The cube in the model's frame: exact.
[[nodiscard]] Cube cube_of(const OctreeRoot& root, const OctreeCube& cube);

/// Bit 0, 1, 2 of `child` (0 to 7) choose the upper half along x, y, z. The colour is left gray.
[[nodiscard]] OctreeCube child_of(const OctreeCube& parent, unsigned child);

/// The volume of so many black cubes, and of the gray ones too, rounded outward.
[[nodiscard]] Enclosure volume(const OctreeRoot& root, const std::vector<OctreeLevel>& levels);

/// An undecided cube with the simplified tree of the model within it.
struct UndecidedCube {
  OctreeCube cube;
  std::shared_ptr<const SetNode> tree;
};

/// Colours children. Immutable: safe to use from many threads.
class SiblingColours {
 public:
  explicit SiblingColours(const Model& model);

  [[nodiscard]] UndecidedCube root() const;

  /// The eight children of a cube; those that stay undecided have a tree.
  [[nodiscard]] std::array<UndecidedCube, 8> operator()(const OctreeRoot& root, const UndecidedCube& parent) const;

 private:
  std::vector<BoxPrimitive> primitives_;
  std::shared_ptr<const SetNode> tree_;
};

// Distances known without any search: for the queries that a time limit leaves.

/// An enclosure of the signed distance of one point.
struct KnownDistance {
  Point at;
  Enclosure distance;
};

/// Enclosures by the model's bounding box, and by distances that are known elsewhere: signed distances change by no
/// more than the way between two points. Immutable: safe to call from many threads.
class CoarseDistance {
 public:
  CoarseDistance(const Model& model, std::vector<KnownDistance> known);

  /// The enclosure of the exact signed distance; an end is infinite if no bound is known.
  [[nodiscard]] Enclosure operator()(const Point& x) const;

 private:
  Box box_;
  std::vector<KnownDistance> known_;
};

/// The same with certificates. The lower end is by bounding spheres or an escape from the bounding box, the upper end
/// by the point of a primitive on the way to its centre. Immutable: safe to call from many threads.
class CoarseProof {
 public:
  /// Throws Error(input) unless the model is_union_of_convex.
  explicit CoarseProof(const Model& model);

  [[nodiscard]] CertifiedEnclosure operator()(const Point& x) const;

  /// The distance of a triangle, 0 if it meets the model.
  [[nodiscard]] CertifiedEnclosure operator()(const Triangle& triangle) const;

  /// The lower end, by bounding spheres alone, which takes some microseconds.
  [[nodiscard]] CertifiedEnclosure by_spheres(const Point& x) const;

 private:
  [[nodiscard]] Normal towards_nearest_centre(const Point& x) const;

  ExactChecker checker_;
  Box box_;
  std::vector<Point> centres_;  ///< centres of the primitives
};

}  // namespace verisq::verify
