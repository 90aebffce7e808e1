/// Octrees: cubes proven inside and outside a model, the volume that follows, and their files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/enclosure.hpp>
#include <verisq/hidden.hpp>
#include <verisq/model.hpp>

namespace verisq {

// How many cubes of each colour a level of an octree has.

/// Cubes of one level that were not split.
struct OctreeLevel {
  std::uint64_t black = 0;
  std::uint64_t white = 0;
  std::uint64_t gray = 0;
};

// Interval octrees: cubes proven inside or outside a solid, and with them its volume between two bounds.

/// Cubes are split level by level until one of the first three says stop.
struct OctreeOptions {
  int depth = 7;           ///< the deepest level, 0 to deepest_octree_level
  double tolerance = 0.0;  ///< enough: the enclosure of the volume is at most this wide, in cubic model units
  /// Largest number of undecided cubes of one level, at least 1. 32 bytes each on a device.
  std::size_t budget = std::size_t{1} << 22U;
  std::string device = "auto";                               ///< "auto", "host", an index or a part of a device's name
  std::function<bool()> interrupted = [] { return false; };  ///< polled; true ends the work, the octree is then valid
  /// Called with the level that is being split, and how many of its undecided cubes are done.
  std::function<void(int level, std::size_t done, std::size_t undecided)> progress = [](int, std::size_t, std::size_t) {
  };
};

struct OctreeSummary {
  OctreeRoot root;
  std::vector<OctreeLevel> levels;  ///< from the root to the deepest level reached
  Enclosure volume;                 ///< of the solid, in cubic model units: black cubes, and black and gray ones
  bool budget_hit = false;          ///< cubes stayed undecided because there was no room for more
  bool interrupted = false;
  std::uint64_t coloured = 0;  ///< cubes whose colour was computed
  std::string device;          ///< name of the device used, or "host"
  std::string notice;          ///< why a device was passed over; empty when nothing to say
  double seconds = 0.0;        ///< from the root to the last cube delivered
  double device_seconds = 0.0;
};

/// Receives the cubes that are not split, each once, in no particular order: together they are the root.
using OctreeSink = std::function<void(std::span<const OctreeCube>)>;

/// A model made ready for octrees: device chosen and tested, kernels compiled.
class OctreeBuilder {
 public:
  /// Throws Error(input) for options out of range, for a device that is not there or failed its self-test, for a model
  /// whose size overflows or is lost in the rounding of its position, for a mesh that is not closed, and for meshes on
  /// a named device: they are the host's.
  OctreeBuilder(const Model& model, const OctreeOptions& options);

  /// Memory is bounded by the budget. Throws Error(failure) for errors of the device, and what the sink throws. One
  /// call at a time. Without a sink the cubes are only counted.
  OctreeSummary build(const OctreeSink& sink = {});

 private:
  struct State;
  Hidden<State> state_;
};

// Octrees as files that ParaView opens.

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

  void append(std::span<const OctreeCube> cubes);

  /// How large the file of the cubes appended so far is: exact, known without writing it.
  [[nodiscard]] std::uint64_t bytes();

  /// Writes the file. `root` is the octree's.
  void finish(const OctreeRoot& root);

 private:
  struct State;
  Hidden<State> state_;
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
