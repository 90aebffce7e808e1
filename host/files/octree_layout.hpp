/// How a `.vtu` holds an octree: text and arrays whose sizes are known before anything is written.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/octree_cube.hpp>

#include "host/files/octree_cells.hpp"

namespace verisq {

/// Where each array of the appended part begins, from the first byte of the file, behind the 8 bytes of its size.
struct OctreeArrays {
  std::uint64_t root, points, connectivity, offsets, types, colour, level;
  std::uint64_t end;  ///< of the file
};

/// Of a file with `points` corners and `cells`, whose XML part has `text_bytes`.
[[nodiscard]] OctreeArrays octree_arrays(std::uint64_t text_bytes, std::uint64_t points, std::uint64_t cells);

/// Whether indices of corners, and the offsets behind them, are of 32 bits.
[[nodiscard]] bool has_narrow_indices(std::uint64_t cells);

class OctreeLayout {
 public:
  using Sink = std::function<void(std::string_view bytes)>;

  /// Eight siblings of one colour become their parent.
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
