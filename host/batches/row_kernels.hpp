/// What every kernel that turns a chunk's points into rows is told and tells.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "host/batches/chunk_queue.hpp"
#include "host/batches/host_memory.hpp"
#include "host/batches/row_sums.hpp"
#include "host/device/device.hpp"
#include "host/opencl/named_kernel.hpp"

namespace verisq::device {

/// Of one work-group, which a look at open rows costs the host at most.
inline constexpr std::size_t rows_of_block = 1024;

[[nodiscard]] constexpr std::size_t blocks_of(std::size_t size) {
  return (size + rows_of_block - 1) / rows_of_block;
}

/// How such kernels divide a chunk among work-items: a vector's device takes a block by one of them, a graphics
/// processor by a group of neighbours.
struct RowGroups {
  explicit RowGroups(const Device& device)
      : width(static_cast<std::size_t>(device.vector_width)), group_size(width > 1 ? 1 : scalar_group_size) {}

  static constexpr std::size_t scalar_group_size = 64;

  std::size_t width;       ///< points of a vector
  std::size_t group_size;  ///< work-items that share a block

  [[nodiscard]] std::size_t vectors_of_item() const { return rows_of_block / width / group_size; }
  [[nodiscard]] std::size_t vectors_of(std::size_t size) const { return (size + width - 1) / width; }
};

/// Sums of a chunk's blocks, and whether a coordinate was refused: in the device's memory and in the host's.
class RowTotals {
 public:
  RowTotals(const Device& device, ChunkQueue& queue, std::size_t capacity);

  void bind(NamedKernel& rows, const RowGroups& groups) const;
  void bind_refusal(NamedKernel& kernel) const { kernel.set("refused", refused_); }
  /// After the kernels; this must stay until the queue has finished.
  void fetch(ChunkQueue& queue, std::size_t size);
  /// Precondition: fetched, and the queue has finished.
  [[nodiscard]] const std::vector<RowSums>& of_blocks() const { return of_blocks_; }
  [[nodiscard]] bool refused() const { return is_refused_ != 0; }
  /// So that the next chunk can be told of. Precondition: the queue has finished.
  void forget_refusal(ChunkQueue& queue);

 private:
  // Kernels do not keep the buffers that they are given.
  cl::Buffer refused_;
  cl::Buffer sums_;
  std::vector<RowSums> of_blocks_;
  cl_uint is_refused_ = 0;
};

void bind_points(NamedKernel& kernel, const BoundChunk& chunk);
void bind_rows(NamedKernel& kernel, const BoundChunk& chunk);
void bind_criterion(NamedKernel& kernel, const Scale& scale, const RowCriterion& criterion);

}  // namespace verisq::device
