/// The undecided cubes of an octree, on the host and on a device, and its growth.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "host/device/device.hpp"
#include "verisq/octree.hpp"

namespace verisq {

// The undecided cubes of an octree's deepest level, wherever they are coloured.

/// The result of one level: its undecided cubes are either split or stay as they are.
struct SplitLevel {
  OctreeLevel children;
  std::uint64_t unsplit = 0;  ///< left gray: no room for their children, or interrupted
};

/// One level after the other, from the root. Precondition of all members: none has thrown before.
class OctreeFront {
 public:
  OctreeFront() = default;
  OctreeFront(const OctreeFront&) = delete;
  OctreeFront& operator=(const OctreeFront&) = delete;
  virtual ~OctreeFront() = default;

  /// Back to the root, undecided.
  virtual void restart() = 0;

  [[nodiscard]] virtual std::size_t undecided() const = 0;

  /// Splits the undecided cubes of `level`; their undecided children take their place. Delivers to `sink`, unless it is
  /// empty, the children that are decided and the cubes that are not split.
  virtual SplitLevel split(int level, const OctreeOptions& options, const OctreeSink& sink) = 0;

  /// Delivers the undecided cubes, of `level`, as they are.
  virtual void deliver_undecided(int level, const OctreeSink& sink) = 0;

  /// Seconds that a device worked since `restart`.
  [[nodiscard]] virtual double device_seconds() const { return 0.0; }
};

}  // namespace verisq

namespace verisq::device {

// The undecided cubes of an octree in the memory of a device.

/// Compiles kernels/octree.cl for the model. `extra_options` are further compiler options (the benchmark uses them:
/// -DNO_SIMPLIFICATION, -DNO_SIBLINGS). Members throw Error(failure) for errors of the device. Precondition: the model
/// is within the device's range. Throws RefusedDevice where cubes of the first levels have false colours.
[[nodiscard]] std::unique_ptr<OctreeFront> octree_front(const Device& device, const Model& model,
                                                        const OctreeRoot& root, const std::string& extra_options = {});

/// With kernels that are not tested before.
[[nodiscard]] std::unique_ptr<OctreeFront> octree_front(const Device& device, const cl::Program& program,
                                                        const Model& model, const OctreeRoot& root);

}  // namespace verisq::device
