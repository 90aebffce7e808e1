/// This file implements the launches of the kernels for single convex primitives.
#include "host/batches/convex_distance.hpp"

#include <algorithm>

namespace verisq::device {
namespace {

constexpr std::size_t scratch_per_point = 8;  // SCRATCH_SIZE in kernels/interior_depth.cl

// Interior search: lanes of a processor's work-item share a block of points, so that none idles; a graphics
// processor's work-item owns one point.
constexpr std::size_t block_points_of_vector_work_item = 512;

// The branch and bound's limit: below this width, relative to the largest semi-axis, it would take ever more cells.
constexpr double smallest_interior_tolerance = 0x1p-30;

}  // namespace

ConvexDistance::ConvexDistance(const Device& device, const cl::Program& program, ChunkQueue& queue,
                               const std::array<cl::Buffer, 3>& coordinates, std::size_t capacity, double tolerance)
    : groups_per_block_(device.vector_width > 1 ? block_points_of_vector_work_item / device.vector_width : 1),
      vectors_(device.vector_width > 1),
      coordinates_(coordinates),
      nearest_(queue.numbers(capacity)),
      scratch_(queue.numbers(capacity * scratch_per_point)),
      point_distance_(program, "point_distance"),
      interior_depth_(program, "interior_depth") {
  for (cl_uint i = 0; i < 3; ++i) {
    point_distance_.setArg(1 + i, coordinates_[i]);
    interior_depth_.setArg(2 + i, coordinates_[i]);
  }
  point_distance_.setArg(6, nearest_);
  interior_depth_.setArg(1, static_cast<cl_uint>(groups_per_block_));
  interior_depth_.setArg(7, std::max(tolerance, smallest_interior_tolerance));
  interior_depth_.setArg(8, scratch_);
}

void ConvexDistance::enqueue(ChunkQueue& queue, const cl::Buffer& primitives, std::size_t index, std::size_t groups,
                             const EvidenceBuffers& evidence) {
  primitives_ = primitives;
  point_distance_.setArg(0, static_cast<cl_ulong>(groups));
  point_distance_.setArg(4, primitives_);
  point_distance_.setArg(5, static_cast<cl_uint>(index));
  interior_depth_.setArg(0, static_cast<cl_ulong>(groups));
  interior_depth_.setArg(5, primitives_);
  interior_depth_.setArg(6, static_cast<cl_uint>(index));
  for (cl_uint i = 0; i < evidence.size(); ++i) {
    point_distance_.setArg(7 + i, evidence[i]);
    interior_depth_.setArg(9 + i, evidence[i]);
  }
  queue.launch(point_distance_, groups);
  // A vector work-item is long here: one a work-group lets the cores share them evenly.
  queue.launch(interior_depth_, (groups + groups_per_block_ - 1) / groups_per_block_, vectors_ ? 1 : usual_group_size);
}

}  // namespace verisq::device
