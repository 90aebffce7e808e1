/// Rows of a chunk by one kernel, with nothing in between: of a single convex primitive, without depths.
#pragma once

#include <cstddef>

#include "host/batches/chunk_queue.hpp"
#include "host/batches/device_model.hpp"
#include "host/batches/host_memory.hpp"
#include "host/batches/row_kernels.hpp"
#include "host/device/device.hpp"
#include "host/opencl/named_kernel.hpp"

namespace verisq::device {

/// Of kernels/point_map.cl. Precondition: `model` has one primitive.
[[nodiscard]] cl::Program point_map_program(const Device& device, const DeviceModel& model);

/// The kernel point_map.
class RowsAtOnce {
 public:
  /// `program` is `point_map_program`. `totals` must outlive this.
  RowsAtOnce(const Device& device, const cl::Program& program, const DeviceModel& model, const RowCriterion& criterion,
             const RowTotals& totals);

  /// The rows of RowsInSteps without depths, bit for bit. Precondition: `size` points, as many as the chunk that is
  /// bound.
  void enqueue(ChunkQueue& queue, const BoundChunk& chunk, std::size_t size);

 private:
  RowGroups groups_;
  cl::Buffer primitives_;  // kernels do not keep the buffers that they are given
  NamedKernel point_map_;
};

}  // namespace verisq::device
