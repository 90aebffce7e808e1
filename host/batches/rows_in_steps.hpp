/// Rows of a chunk kernel by kernel, with columns in between: of any union of convex primitives, with depths.
#pragma once

#include <cstddef>

#include "host/batches/chunk_queue.hpp"
#include "host/batches/device_model.hpp"
#include "host/batches/host_memory.hpp"
#include "host/batches/point_kernels.hpp"
#include "host/batches/row_kernels.hpp"
#include "host/device/device.hpp"
#include "host/opencl/named_kernel.hpp"

namespace verisq::device {

/// The kernels point_columns, those of PointKernels, and point_rows.
class RowsInSteps {
 public:
  /// `programs` are `point_programs`. `totals` must outlive this.
  RowsInSteps(const Device& device, const PointPrograms& programs, const DeviceModel& model, ChunkQueue& queue,
              const RowCriterion& criterion, const RowTotals& totals);

  /// `searched`: depths, too; otherwise those of points inside are unknown, which their rows say. Preconditions: `size`
  /// points, as many as the chunk that is bound.
  void enqueue(ChunkQueue& queue, const BoundChunk& chunk, std::size_t size, bool searched);
  /// After the former without depths, and while the chunk is bound: all of it again with them.
  void enqueue_depths(ChunkQueue& queue, std::size_t size);

 private:
  void enqueue_rows(ChunkQueue& queue, std::size_t size);
  // A graphics processor's work-item takes one point, next to those of its neighbours.
  [[nodiscard]] std::size_t vectors_of_columns() const {
    return groups_.group_size == 1 ? groups_.vectors_of_item() : 1;
  }

  RowGroups groups_;
  Scale scale_;
  PointKernels kernels_;
  NamedKernel point_columns_;
  NamedKernel point_rows_;
};

}  // namespace verisq::device
