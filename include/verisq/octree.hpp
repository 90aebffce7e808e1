/// Interval octrees: cubes proven inside or outside a solid, and with them its volume between two bounds.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>
#include <verisq/enclosure.hpp>
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

/// Cubes of one level that were not split.
struct OctreeLevel {
  std::uint64_t black = 0;
  std::uint64_t white = 0;
  std::uint64_t gray = 0;
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
  /// Throws Error(input) for options out of range, for a device that is not there or failed its self-test, and for a
  /// model whose size overflows or is lost in the rounding of its position.
  OctreeBuilder(const Model& model, const OctreeOptions& options);
  ~OctreeBuilder();
  OctreeBuilder(OctreeBuilder&&) noexcept;
  OctreeBuilder& operator=(OctreeBuilder&&) noexcept;

  /// Memory is bounded by the budget. Throws Error(failure) for errors of the device, and what the sink throws. One
  /// call at a time. Without a sink the cubes are only counted.
  OctreeSummary build(const OctreeSink& sink = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace verisq
