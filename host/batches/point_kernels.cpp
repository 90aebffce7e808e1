/// This file implements the launches for a union of convex primitives.
#include "host/batches/point_kernels.hpp"

#include <string_view>

#include "host/batches/kernel_arguments.hpp"
#include "kernels/embedded_sources.hpp"

namespace verisq::device {
namespace {

constexpr std::array<std::string_view, 3> escape_arguments{"escape_xs", "escape_ys", "escape_zs"};

}  // namespace

PointKernels::PointKernels(const Device& device, const PointPrograms& programs, const DeviceModel& model,
                           ChunkQueue& queue, double tolerance)
    : count_(model.count),
      primitives_(model.primitives),
      tapered_(model.tapered),
      points_{{queue.numbers(model.chunk_size), queue.numbers(model.chunk_size), queue.numbers(model.chunk_size)},
              queue.numbers(model.chunk_size)},
      convex_distance_(device, programs, queue, model.chunk_size, tolerance),
      union_distance_(programs.untapered, kernels::embedded_point_sources(), "union_distance") {
  const std::size_t capacity = model.chunk_size;
  for (cl::Buffer& evidence : per_primitive_) evidence = queue.numbers(capacity * count_);
  ends_[0] = count_ > 1 ? queue.numbers(capacity) : per_primitive_[0];
  ends_[1] = count_ > 1 ? queue.numbers(capacity) : per_primitive_[1];
  for (cl::Buffer& escape : escapes_) escape = queue.numbers(count_ > 1 ? capacity : 1);

  union_distance_.set("stride", capacity);
  union_distance_.set(coordinate_arguments, points_.coordinates);
  union_distance_.set("primitives", primitives_);
  union_distance_.set("count", count_);
  union_distance_.set(evidence_arguments, per_primitive_);
  union_distance_.set(union_arguments, ends_);
  union_distance_.set(escape_arguments, escapes_);
  views_ = views_of_primitives(per_primitive_, count_, capacity);
}

void PointKernels::enqueue(ChunkQueue& queue, std::size_t groups) {
  enqueue_distances(queue, groups);
  enqueue_depths(queue, groups);
  enqueue_union(queue, groups);
}

void PointKernels::enqueue_outside(ChunkQueue& queue, std::size_t groups) {
  enqueue_distances(queue, groups);
  enqueue_union(queue, groups);
}

void PointKernels::enqueue_inside(ChunkQueue& queue, std::size_t groups) {
  enqueue_depths(queue, groups);
  enqueue_union(queue, groups);
}

void PointKernels::enqueue_distances(ChunkQueue& queue, std::size_t groups) {
  for (std::size_t index = 0; index < count_; ++index)
    convex_distance_.enqueue_distances(queue, points_, {primitives_, index, tapered_[index]}, groups, views_[index]);
}

void PointKernels::enqueue_depths(ChunkQueue& queue, std::size_t groups) {
  for (std::size_t index = 0; index < count_; ++index)
    convex_distance_.enqueue_depths(queue, points_, {primitives_, index, tapered_[index]}, groups, views_[index]);
}

void PointKernels::enqueue_union(ChunkQueue& queue, std::size_t groups) {
  if (count_ == 1) return;
  union_distance_.set("groups", groups);
  queue.launch(union_distance_, groups);
}

}  // namespace verisq::device
