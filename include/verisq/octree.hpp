/// Interval octrees: cubes proven inside or outside a solid, and with them its volume between two bounds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>
#include <verisq/enclosure.hpp>
#include <verisq/model.hpp>
#include <verisq/octree_cube.hpp>
#include <verisq/octree_level.hpp>

namespace verisq {

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
