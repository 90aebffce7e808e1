/// This file implements the launches from the caller's points to his rows, with columns in between.
#include "host/batches/rows_in_steps.hpp"

#include "host/batches/kernel_arguments.hpp"
#include "kernels/embedded_sources.hpp"

namespace verisq::device {

RowsInSteps::RowsInSteps(const Device& device, const PointPrograms& programs, const DeviceModel& model,
                         ChunkQueue& queue, const RowCriterion& criterion, const RowTotals& totals)
    : groups_(device),
      scale_(model.scale_exponent),
      kernels_(device, programs, model, queue, scale_.to_device(criterion.tolerance)),
      point_columns_(programs.untapered, kernels::embedded_point_sources(), "point_columns"),
      point_rows_(programs.untapered, kernels::embedded_point_sources(), "point_rows") {
  point_columns_.set("vectors", vectors_of_columns());
  point_columns_.set("factor", scale_.factor());
  point_columns_.set(coordinate_arguments, kernels_.coordinates());
  totals.bind_refusal(point_columns_);
  point_rows_.set("vectors", groups_.vectors_of_item());
  bind_criterion(point_rows_, scale_, criterion);
  point_rows_.set(coordinate_arguments, kernels_.coordinates());
  point_rows_.set(union_arguments, kernels_.ends());
  totals.bind(point_rows_, groups_);
}

void RowsInSteps::enqueue(ChunkQueue& queue, const BoundChunk& chunk, std::size_t size, bool searched) {
  point_columns_.set("size", size);
  bind_points(point_columns_, chunk);
  point_rows_.set("size", size);
  bind_rows(point_rows_, chunk);
  const std::size_t vectors = groups_.vectors_of(size);
  const std::size_t items = (vectors + vectors_of_columns() - 1) / vectors_of_columns();
  groups_.group_size == 1 ? queue.launch(point_columns_, items, 1) : queue.launch(point_columns_, items);
  searched ? kernels_.enqueue(queue, vectors) : kernels_.enqueue_outside(queue, vectors);
  enqueue_rows(queue, size);
}

void RowsInSteps::enqueue_depths(ChunkQueue& queue, std::size_t size) {
  kernels_.enqueue_inside(queue, groups_.vectors_of(size));
  enqueue_rows(queue, size);
}

void RowsInSteps::enqueue_rows(ChunkQueue& queue, std::size_t size) {
  queue.launch(point_rows_, blocks_of(size) * groups_.group_size, groups_.group_size);
}

}  // namespace verisq::device
