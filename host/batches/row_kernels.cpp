/// This file implements the arguments of kernels that turn points into rows.
#include "host/batches/row_kernels.hpp"

#include <array>
#include <span>
#include <string_view>

namespace verisq::device {
namespace {

constexpr std::array<std::string_view, 3> axes{"x", "y", "z"};

void bind(NamedKernel& kernel, std::string_view name, const BoundColumn& column) {
  const std::string of(name);
  kernel.set("memory_" + of, column.buffer);
  kernel.set("offset_" + of, column.offset);
  kernel.set("stride_" + of, column.stride);
}

}  // namespace

RowTotals::RowTotals(const Device& device, ChunkQueue& queue, std::size_t capacity)
    : refused_(device.context, CL_MEM_READ_WRITE, sizeof(cl_uint)),
      sums_(device.context, CL_MEM_WRITE_ONLY, blocks_of(capacity) * sizeof(RowSums)) {
  forget_refusal(queue);
}

void RowTotals::bind(NamedKernel& rows, const RowGroups& groups) const {
  rows.set("sums", sums_);
  rows.set("of_items", cl::Local(groups.group_size * sizeof(RowSums)));
}

void RowTotals::fetch(ChunkQueue& queue, std::size_t size) {
  queue.read_bytes(refused_, std::as_writable_bytes(std::span(&is_refused_, 1)));
  of_blocks_.resize(blocks_of(size));
  queue.read_bytes(sums_, std::as_writable_bytes(std::span(of_blocks_)));
}

void RowTotals::forget_refusal(ChunkQueue& queue) {
  queue.clear(refused_, sizeof(cl_uint));
}

void bind_points(NamedKernel& kernel, const BoundChunk& chunk) {
  for (std::size_t i = 0; i < axes.size(); ++i) bind(kernel, axes[i], chunk.coordinates[i]);
}

void bind_rows(NamedKernel& kernel, const BoundChunk& chunk) {
  bind(kernel, "lo", chunk.ends[0]);
  bind(kernel, "hi", chunk.ends[1]);
  bind(kernel, "status", chunk.status);
}

void bind_criterion(NamedKernel& kernel, const Scale& scale, const RowCriterion& criterion) {
  kernel.set("factor", scale.factor());
  kernel.set("inverse", scale.inverse());
  kernel.set("tolerance", criterion.tolerance);
  kernel.set("inside", criterion.inside);
  kernel.set("outside", criterion.outside);
  kernel.set("radius", criterion.radius);
}

}  // namespace verisq::device
