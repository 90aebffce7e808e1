/// What kernels make of a chunk of points in columns: enclosures of its distances to a union of convex primitives.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "host/batches/chunk_queue.hpp"
#include "host/batches/convex_distance.hpp"
#include "host/batches/device_model.hpp"
#include "host/device/device.hpp"
#include "host/opencl/named_kernel.hpp"

namespace verisq::device {

/// The kernels of single primitives and that of their union, with the buffers of one chunk.
class PointKernels {
 public:
  /// `programs` are `point_programs`; `tolerance` in the device's numbers.
  PointKernels(const Device& device, const PointPrograms& programs, const DeviceModel& model, ChunkQueue& queue,
               double tolerance);

  /// x, y, z, in the device's numbers: to be written before `enqueue`, in whole vectors.
  [[nodiscard]] const std::array<cl::Buffer, 3>& coordinates() const { return points_.coordinates; }
  /// Lower and upper ends, likewise.
  [[nodiscard]] const std::array<cl::Buffer, 2>& ends() const { return ends_; }
  /// What is found for each primitive, and a point outside of all of them for each point: not of a single primitive.
  [[nodiscard]] const std::vector<EvidenceBuffers>& evidence() const { return views_; }
  [[nodiscard]] const std::array<cl::Buffer, 3>& escapes() const { return escapes_; }

  /// For the first `groups` vectors of points.
  void enqueue(ChunkQueue& queue, std::size_t groups);
  /// Likewise, and final where a lower end is above 0, or an enclosure not wider than the tolerance. Others are
  /// valid: upper ends are those of any point inside.
  void enqueue_outside(ChunkQueue& queue, std::size_t groups);
  /// After that: all of the others, too.
  void enqueue_inside(ChunkQueue& queue, std::size_t groups);

 private:
  void enqueue_distances(ChunkQueue& queue, std::size_t groups);
  void enqueue_depths(ChunkQueue& queue, std::size_t groups);
  void enqueue_union(ChunkQueue& queue, std::size_t groups);

  std::size_t count_;  // of primitives
  // Kernels do not keep the buffers that they are given.
  cl::Buffer primitives_;
  std::vector<bool> tapered_;  // which primitives are
  ConvexDistance::Points points_;
  ConvexDistance convex_distance_;
  NamedKernel union_distance_;
  EvidenceBuffers per_primitive_;  // primitive by primitive
  std::array<cl::Buffer, 2> ends_;
  std::array<cl::Buffer, 3> escapes_;
  std::vector<EvidenceBuffers> views_;  // windows of those, one for each primitive
};

}  // namespace verisq::device
