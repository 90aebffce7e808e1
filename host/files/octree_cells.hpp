/// What a file of an octree holds: equal siblings merged into their parent, corners shared.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>
#include <verisq/octree_cube.hpp>

namespace verisq {

/// Eight children of one colour become their parent, as often as there are such. In the order of colours, levels and
/// positions.
[[nodiscard]] std::vector<OctreeCube> merged(std::span<const OctreeCube> cubes);

/// The different corners of cubes, in the order of z, then y, then x.
class SharedCorners {
 public:
  using LatticePoint = std::array<std::uint32_t, 3>;  ///< in edges of cubes of `level`, from the root's lower corner

  explicit SharedCorners(std::span<const OctreeCube> cubes);

  [[nodiscard]] int level() const { return level_; }  ///< the deepest of the cubes
  [[nodiscard]] std::size_t size() const { return keys_.size(); }
  [[nodiscard]] LatticePoint operator[](std::size_t index) const;

  /// The indices of the cube's corners: those with its lower z counterclockwise as seen from above, then those above
  /// them (the order of a hexahedron of VTK). Precondition: it is one of the cubes.
  [[nodiscard]] std::array<std::uint64_t, 8> of(const OctreeCube& cube) const;

 private:
  int level_ = 0;
  std::vector<std::uint64_t> keys_;        ///< rising
  std::vector<std::uint64_t> first_of_z_;  ///< where the keys of each z begin
};

}  // namespace verisq
