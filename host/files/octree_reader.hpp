/// The layout of an octree in a `.vtu`, and the reader of OctreeWriter's files, to the byte.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/checker.hpp>

namespace verisq {

// The contents of an octree's file: equal siblings merged into their parent, corners shared.

/// Replaces eight children of one colour by their parent, as often as possible. In the order of colours, levels and
/// positions.
[[nodiscard]] std::vector<OctreeCube> merged(std::span<const OctreeCube> cubes);

/// The distinct corners of cubes, in the order of z, then y, then x.
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
  std::vector<std::uint64_t> first_of_z_;  ///< the beginning of the keys of each z
};

// The layout of an octree in a `.vtu`: text and arrays whose sizes are known before anything is written.

/// The beginning of each array of the appended part, from the first byte of the file, behind the 8 bytes of its size.
struct OctreeArrays {
  std::uint64_t root, points, connectivity, offsets, types, colour, level;
  std::uint64_t end;  ///< end of the file
};

/// The arrays of a file with `points` corners and `cells`, whose XML part has `text_bytes`.
[[nodiscard]] OctreeArrays octree_arrays(std::uint64_t text_bytes, std::uint64_t points, std::uint64_t cells);

/// Returns whether indices of corners, and the offsets behind them, have 32 bits.
[[nodiscard]] bool has_narrow_indices(std::uint64_t cells);

class OctreeLayout {
 public:
  using Sink = std::function<void(std::string_view bytes)>;

  /// Replaces eight siblings of one colour by their parent.
  explicit OctreeLayout(std::span<const OctreeCube> cubes);

  [[nodiscard]] std::uint64_t bytes() const;

  /// All bytes of the file, one after the other.
  void write(const Sink& sink, const OctreeRoot& root) const;

 private:
  void write_points(const Sink& sink, const OctreeRoot& root) const;
  template <class Index>
  void write_cells(const Sink& sink) const;

  std::vector<OctreeCube> cubes_;
  SharedCorners corners_;
  std::string text_;
};

}  // namespace verisq
