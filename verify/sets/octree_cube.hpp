/// The octree of a solid: its root, exact cubes, the colours of eight siblings, volumes (docs/mathematics.md §10).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "verify/sets/box_primitive.hpp"
#include "verify/sets/cube.hpp"
#include "verify/sets/set_tree.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/octree_cube.hpp"
#include "verisq/octree_level.hpp"

namespace verisq::verify {

/// Contains the model's solid. Throws Error(input) where no such cube has exact corners.
[[nodiscard]] OctreeRoot octree_root(const Model& model);

/// The cube in the model's frame: exact.
[[nodiscard]] Cube cube_of(const OctreeRoot& root, const OctreeCube& cube);

/// Bit 0, 1, 2 of `child` (0 to 7) choose the upper half along x, y, z. The colour is left gray.
[[nodiscard]] OctreeCube child_of(const OctreeCube& parent, unsigned child);

/// The volume of so many black cubes, and of the gray ones too, rounded outward.
[[nodiscard]] Enclosure volume(const OctreeRoot& root, const std::vector<OctreeLevel>& levels);

/// An undecided cube with what is left of the model's tree within it.
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

}  // namespace verisq::verify
