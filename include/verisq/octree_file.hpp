/// Octrees as files that ParaView opens.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>
#include <verisq/octree_cube.hpp>

namespace verisq {

/// Whether white cubes, of which a viewer sees nothing, are written too.
enum class WhiteCubes { left_out, written };

/// Writes the cubes of one octree to a `.vtu` (VTK XML, unstructured grid of hexahedra that share their corners) with
/// the cell data `colour` (0 white, 1 gray, 2 black) and `level`. Eight siblings of one colour are written as their
/// parent: the same picture and volumes, in fewer cells. The file appears when it is complete, cells in the order of
/// their colours, levels and positions: the same octree gives the same file. All members throw Error(failure) naming
/// the file and the reason.
class OctreeWriter {
 public:
  /// Throws Error(input) unless the name ends in `.vtu`.
  OctreeWriter(const std::filesystem::path& file, WhiteCubes white);
  ~OctreeWriter();
  OctreeWriter(OctreeWriter&&) noexcept;
  OctreeWriter& operator=(OctreeWriter&&) noexcept;

  void append(std::span<const OctreeCube> cubes);

  /// How large the file of the cubes appended so far is: exact, known without writing it.
  [[nodiscard]] std::uint64_t bytes();

  /// Writes the file. `root` is the octree's.
  void finish(const OctreeRoot& root);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// An octree as its file holds it: white cubes may be left out.
struct OctreeContents {
  OctreeRoot root;
  std::vector<OctreeCube> cubes;
};

/// Throws Error(input), naming the file and what is wrong, for any other bytes than those that OctreeWriter writes of
/// these cubes.
[[nodiscard]] OctreeContents read_octree(const std::filesystem::path& path);

}  // namespace verisq
