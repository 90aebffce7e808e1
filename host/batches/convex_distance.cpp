/// This file implements the launches of the kernels for single convex primitives.
#include "host/batches/convex_distance.hpp"

#include <algorithm>
#include <string_view>

#include "host/batches/kernel_arguments.hpp"
#include "host/batches/rows_side_by_side.hpp"
#include "host/opencl/program.hpp"
#include "kernels/embedded_sources.hpp"

namespace verisq::device {
namespace {

constexpr std::size_t scratch_per_point = 12;  // SCRATCH_SIZE in kernels/interior_depth.cl

// Lanes of a processor's work-item share a block of points where only some need work, so that none idles; a graphics
// processor's work-item owns one point.
constexpr std::size_t block_points_of_vector_work_item = rows_side_by_side;

// The branch and bound's limit: below this width, relative to the largest semi-axis, it would take ever more cells.
constexpr double smallest_interior_tolerance = 0x1p-30;

}  // namespace

std::vector<EvidenceBuffers> views_of_primitives(const EvidenceBuffers& all, std::size_t count, std::size_t capacity) {
  std::vector<EvidenceBuffers> views(count);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::vector<cl::Buffer> columns = windows(all[i], count, capacity);
    for (std::size_t index = 0; index < count; ++index) views[index][i] = columns[index];
  }
  return views;
}

PointPrograms point_programs(const Device& device, const std::string& memory, bool tapered) {
  const auto program = [&](std::string_view sources) {
    return build_program(device.context, device.device, device.vector_width, sources, memory);
  };
  PointPrograms programs(program(kernels::embedded_point_sources()));
  if (tapered) programs.tapered = program(kernels::embedded_tapered_sources());
  return programs;
}

ConvexDistance::ConvexDistance(const Device& device, const PointPrograms& programs, ChunkQueue& queue,
                               std::size_t capacity, double tolerance)
    : capacity_(capacity),
      groups_per_block_(device.vector_width > 1 ? block_points_of_vector_work_item / device.vector_width : 1),
      listed_(queue.numbers(capacity / 2 + 1)),  // as 32-bit numbers
      untapered_(kernels_of(programs.untapered, kernels::embedded_point_sources(), tolerance)) {
  if (programs.tapered) tapered_ = kernels_of(*programs.tapered, kernels::embedded_tapered_sources(), tolerance);
}

ConvexDistance::Kernels ConvexDistance::kernels_of(const cl::Program& program, std::string_view sources,
                                                   double tolerance) const {
  Kernels kernels{{program, sources, "point_distance"}, {program, sources, "interior_depth"}};
  for (NamedKernel* const kernel : {&kernels.distance, &kernels.depth})
    kernel->set("groups_per_block", groups_per_block_);
  kernels.distance.set("listed", listed_);
  kernels.depth.set("tolerance", std::max(tolerance, smallest_interior_tolerance));
  return kernels;
}

void ConvexDistance::enqueue_distances(ChunkQueue& queue, const Points& points, const Primitive& primitive,
                                       std::size_t groups, const EvidenceBuffers& evidence) {
  points_ = points;
  of(primitive).distance.set("nearest", points_.nearest);
  enqueue(queue, of(primitive).distance, points, primitive, groups, evidence);
}

void ConvexDistance::enqueue_depths(ChunkQueue& queue, const Points& points, const Primitive& primitive,
                                    std::size_t groups, const EvidenceBuffers& evidence) {
  if (scratch_() == nullptr) scratch_ = queue.numbers(capacity_ * scratch_per_point);
  of(primitive).depth.set("scratch", scratch_);
  enqueue(queue, of(primitive).depth, points, primitive, groups, evidence);
}

void ConvexDistance::enqueue(ChunkQueue& queue, NamedKernel& kernel, const Points& points, const Primitive& primitive,
                             std::size_t groups, const EvidenceBuffers& evidence) {
  points_ = points;
  primitives_ = primitive.primitives;
  kernel.set("groups", groups);
  kernel.set(coordinate_arguments, points_.coordinates);
  kernel.set("primitives", primitives_);
  kernel.set("index", primitive.index);
  kernel.set(evidence_arguments, evidence);
  // A vector work-item with a block is long: one a work-group lets the cores share them evenly.
  const std::size_t blocks = (groups + groups_per_block_ - 1) / groups_per_block_;
  groups_per_block_ > 1 ? queue.launch(kernel, blocks, 1) : queue.launch(kernel, blocks);
}

}  // namespace verisq::device
