/// The cubes of an octree, exactly where they are.
#pragma once

#include <array>
#include <cstdint>
#include <verisq/model.hpp>

namespace verisq {

/// What is proven of a cube. The numbers are those of the array `colour` in a `.vtu`.
enum class CubeColour : std::uint8_t {
  white = 0,  ///< no point of it lies in the solid
  gray = 1,   ///< undecided
  black = 2,  ///< all of it lies in the solid's interior
};

/// The cube from which an octree grows. It contains the solid. Half-width and grid are powers of two, so that the
/// corners of all its cubes are binary64 numbers: nothing is rounded.
struct OctreeRoot {
  Point centre;
  double half_width;
};

/// A cube that was not split. Cube (i, j, k) of level l is the one with lower corner
/// centre - half_width + (i, j, k) edge, edge = 2 half_width / 2^l, of the root.
struct OctreeCube {
  std::array<std::uint32_t, 3> position;
  std::uint8_t level;
  CubeColour colour;
};

/// Edge of the cubes of a level, and lower corner of a cube: both exact.
[[nodiscard]] double edge(const OctreeRoot& root, int level);
[[nodiscard]] Point lower_corner(const OctreeRoot& root, const OctreeCube& cube);

/// No cube is split beyond this level: positions have 20 bits.
inline constexpr int deepest_octree_level = 20;

}  // namespace verisq
